#include "app/formats/gltf/gltf_mesh.h"

#include "app/formats/gltf/gltf_load.h"
#include "app/formats/splats/splats.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace gs::app {
namespace {

constexpr int kMaxHarmonics = 3;  // max degree of spherical harmonics in KHR_gaussian_splatting

int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

std::int32_t as_index(std::uint32_t index) {
  return index < static_cast<std::uint32_t>(kBadIndex) ? static_cast<std::int32_t>(index) : kBadIndex;
}

/// Writer of the corners of a primitive, as faces or lines that end with -1 (glTF 2.0 3.7.2.1).
class CornerWriter {
 public:
  CornerWriter(const std::vector<std::uint32_t>& indices, ImportContext& context)
      : indices_(indices), corners_(context) {}

  vrml::MFInt32 triangles() {
    for (std::size_t i = 0; i + 2 < indices_.size(); i += 3) put({i, i + 1, i + 2});
    return corners_.take();
  }
  vrml::MFInt32 strip() {
    for (std::size_t i = 0; i + 2 < indices_.size(); ++i) put({i, i + 1 + i % 2, i + 2 - i % 2});
    return corners_.take();
  }
  vrml::MFInt32 fan() {
    for (std::size_t i = 0; i + 2 < indices_.size(); ++i) put({i + 1, i + 2, 0});
    return corners_.take();
  }
  vrml::MFInt32 lines() {
    for (std::size_t i = 0; i + 1 < indices_.size(); i += 2) put({i, i + 1});
    return corners_.take();
  }
  vrml::MFInt32 line_strip(bool closed) {
    for (const std::uint32_t i : indices_) corners_.push(as_index(i));
    if (closed && !indices_.empty()) corners_.push(as_index(indices_.front()));
    corners_.push(kFaceEnd);
    return corners_.take();
  }

 private:
  void put(std::initializer_list<std::size_t> places) {
    for (const std::size_t place : places) corners_.push(as_index(indices_[place]));
    corners_.push(kFaceEnd);
  }
  const std::vector<std::uint32_t>& indices_;
  Appender<std::int32_t> corners_;
};

template <class T>
Array<T> gathered(const Array<T>& values, const std::vector<std::uint32_t>& indices, ImportContext& context) {
  Appender<T> result(context);
  for (const std::uint32_t i : indices)
    if (i < values.size()) result.push(values[i]);
  return result.take();
}

}  // namespace

vrml::NodeId GltfMeshes::node(int mesh) {
  const auto [entry, added] = nodes_.try_emplace(mesh);
  if (!added) return entry->second;
  vrml::MFNode shapes = make(mesh, nullptr);
  if (shapes.size() == 1) {
    entry->second = shapes.front();
  } else if (!shapes.empty()) {
    entry->second = builder_.make(vrml::NodeKind::transform);  // several types are of the kind `group`
    builder_.set(entry->second, "children", std::move(shapes));
  }
  return entry->second;
}

vrml::MFNode GltfMeshes::skinned_shapes(int mesh, const std::vector<glm::mat4>& joints) { return make(mesh, &joints); }

vrml::MFNode GltfMeshes::make(int index, const std::vector<glm::mat4>* joints) {
  vrml::MFNode shapes;
  if (index < 0 || static_cast<std::size_t>(index) >= model_.meshes.size()) {
    builder_.fail("mesh " + std::to_string(index) + " does not exist");
    return shapes;
  }
  const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(index)];
  for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
    const std::string where = "mesh " + std::to_string(index) + (mesh.name.empty() ? "" : " (" + mesh.name + ")") +
                              ", primitive " + std::to_string(i) + ": ";
    const vrml::NodeId shape = make_shape(mesh.primitives[i], where, joints);
    if (!shape) continue;
    builder_.name(shape, mesh.name);
    shapes.push_back(shape);
  }
  return shapes;
}

vrml::NodeId GltfMeshes::make_shape(const tinygltf::Primitive& primitive, const std::string& where,
                                    const std::vector<glm::mat4>* joints) {
  if (primitive.extensions.contains(kDracoExtension)) {
    builder_.fail(where + kDracoExtension + " is not supported; the primitive is left out");
    return {};
  }
  report_splats(primitive);
  const GltfSurface surface = materials_.surface(primitive.material);
  Geometry geometry;
  if (!read_attributes(primitive, surface, where, geometry)) return {};
  if (joints) skin(primitive, *joints, where, geometry);
  if (!read_corners(primitive, where, geometry)) return {};
  geometry.solid = !surface.double_sided;
  const bool glowing = geometry.kind != Geometry::Kind::faces;
  const vrml::NodeId node = builder_.geometry(std::move(geometry));
  return node ? builder_.shape(node, materials_.appearance(primitive.material, glowing)) : vrml::NodeId{};
}

void GltfMeshes::report_splats(const tinygltf::Primitive& primitive) {
  const std::string extension = "KHR_gaussian_splatting", prefix = extension + ":";
  if (splats_reported_ || !primitive.extensions.contains(extension)) return;
  std::string lost;
  if (const int accessor = attribute(primitive, prefix + "OPACITY"); accessor >= 0)
    if (const auto opacities = accessors_.floats(accessor, 1, true))
      if (std::any_of(opacities->begin(), opacities->end(), [](float opacity) { return opacity < kOpaque; }))
        lost = "opacity";
  int degree = 0;
  while (degree < kMaxHarmonics &&
         attribute(primitive, prefix + "SH_DEGREE_" + std::to_string(degree + 1) + "_COEF_0") >= 0)
    ++degree;
  if (degree > 0)
    lost += (lost.empty() ? "" : " and ") + std::string("spherical harmonics up to degree ") + std::to_string(degree);
  if (lost.empty()) return;
  splats_reported_ = true;
  builder_.note("splats are drawn as opaque points, without their " + lost);
}

std::optional<vrml::MFVec3f> GltfMeshes::vectors(int accessor) {
  const auto [entry, added] = vectors_.try_emplace(accessor);
  if (!added) return entry->second;
  const auto values = accessors_.floats(accessor, 3);
  if (!values) {
    vectors_.erase(entry);
    return std::nullopt;
  }
  const std::size_t count = values->size() / 3;
  if (count > 0) {
    glm::vec3* to = entry->second.prepare(count);
    for (std::size_t i = 0; i < count; ++i) to[i] = {(*values)[3 * i], (*values)[3 * i + 1], (*values)[3 * i + 2]};
    entry->second.commit(count);
  }
  return entry->second;
}

bool GltfMeshes::read_attributes(const tinygltf::Primitive& primitive, const GltfSurface& surface,
                                 const std::string& where, Geometry& geometry) {
  const auto fits = [&](const char* name, std::size_t count) {
    if (count >= geometry.positions.size()) return true;
    builder_.warn(where + name + " has " + std::to_string(count) + " values; expected " +
                  std::to_string(geometry.positions.size()));
    return false;
  };
  const auto positions = vectors(attribute(primitive, "POSITION"));
  if (!positions) {
    builder_.fail(where + "POSITION: " + accessors_.problem());
    return false;
  }
  geometry.positions = *positions;
  if (const int accessor = attribute(primitive, "NORMAL"); accessor >= 0) {
    const auto normals = vectors(accessor);
    if (!normals)
      builder_.warn(where + "NORMAL: " + accessors_.problem());
    else if (fits("NORMAL", normals->size()))
      geometry.normals = *normals;
  }
  // A texture with colours replaces the vertex colours (VRML97 Table 4.6).
  if (const int accessor = attribute(primitive, "COLOR_0"); accessor >= 0 && !surface.has_base) {
    read_colors(accessor, surface, where, geometry);
    if (!geometry.colors.empty() && !fits("COLOR_0", geometry.colors.size())) geometry.colors.clear();
  }
  const std::string set = "TEXCOORD_" + std::to_string(surface.texture_set);
  if (const int accessor = attribute(primitive, set); accessor >= 0 && surface.textured) {
    read_texture_coordinates(accessor, surface, where, geometry);
    if (!geometry.texture_coordinates.empty() && !fits(set.c_str(), geometry.texture_coordinates.size()))
      geometry.texture_coordinates.clear();
  }
  return true;
}

void GltfMeshes::read_colors(int accessor, const GltfSurface& surface, const std::string& where, Geometry& geometry) {
  const int width = accessors_.components(accessor) == 4 ? 4 : 3;
  const auto values = accessors_.floats(accessor, width, true);
  if (!values) {
    builder_.warn(where + "COLOR_0: " + accessors_.problem());
    return;
  }
  Appender<vrml::Color> colors(builder_);
  for (std::size_t i = 0; i + 2 < values->size(); i += static_cast<std::size_t>(width))
    colors.push({display_of_linear((*values)[i] * surface.factor.x),
                 display_of_linear((*values)[i + 1] * surface.factor.y),
                 display_of_linear((*values)[i + 2] * surface.factor.z)});
  geometry.colors = colors.take();
}

void GltfMeshes::read_texture_coordinates(int accessor, const GltfSurface& surface, const std::string& where,
                                          Geometry& geometry) {
  const auto known = texture_coordinates_.find(accessor);
  if (!surface.transform && known != texture_coordinates_.end()) {
    geometry.texture_coordinates = known->second;
    return;
  }
  const auto values = accessors_.floats(accessor, 2);
  if (!values) {
    builder_.warn(where + "TEXCOORD: " + accessors_.problem());
    return;
  }
  Appender<glm::vec2> coordinates(builder_);
  for (std::size_t i = 0; i + 1 < values->size(); i += 2) {
    glm::vec2 uv((*values)[i], (*values)[i + 1]);
    if (surface.transform) uv = surface.transform->apply(uv);
    // glTF counts texture rows from the top, VRML97 from the bottom.
    coordinates.push({uv.x, 1 - uv.y});
  }
  geometry.texture_coordinates = coordinates.take();
  if (!surface.transform) texture_coordinates_[accessor] = geometry.texture_coordinates;
}

bool GltfMeshes::read_corners(const tinygltf::Primitive& primitive, const std::string& where, Geometry& geometry) {
  Indices indices;
  if (primitive.indices >= 0) {
    auto read = accessors_.integers(primitive.indices, 1);
    if (!read) {
      builder_.fail(where + "indices: " + accessors_.problem());
      return false;
    }
    indices = std::move(*read);
  } else {
    indices.resize(geometry.positions.size());
    std::iota(indices.begin(), indices.end(), 0u);
  }
  // Each index becomes at most four numbers of four bytes.
  if (!accessors_.charge(indices.size() * 16)) {
    builder_.fail(where + accessors_.problem());
    return false;
  }
  CornerWriter writer(indices, builder_);
  geometry.kind = Geometry::Kind::faces;
  switch (primitive.mode) {
    case TINYGLTF_MODE_TRIANGLES:
      geometry.coord_index = writer.triangles();
      return true;
    case TINYGLTF_MODE_TRIANGLE_STRIP:
      geometry.coord_index = writer.strip();
      return true;
    case TINYGLTF_MODE_TRIANGLE_FAN:
      geometry.coord_index = writer.fan();
      return true;
    default:
      break;
  }
  geometry.normals.clear();
  geometry.texture_coordinates.clear();
  geometry.kind = Geometry::Kind::lines;
  switch (primitive.mode) {
    case TINYGLTF_MODE_LINE:
      geometry.coord_index = writer.lines();
      return true;
    case TINYGLTF_MODE_LINE_LOOP:
      geometry.coord_index = writer.line_strip(true);
      return true;
    case TINYGLTF_MODE_LINE_STRIP:
      geometry.coord_index = writer.line_strip(false);
      return true;
    case TINYGLTF_MODE_POINTS:
      break;
    default:
      builder_.fail(where + "unknown mode " + std::to_string(primitive.mode) + "; expected 0 to 6");
      return false;
  }
  geometry.kind = Geometry::Kind::points;
  if (primitive.indices < 0) return true;
  geometry.positions = gathered(geometry.positions, indices, builder_);
  geometry.colors = gathered(geometry.colors, indices, builder_);
  return true;
}

void GltfMeshes::skin(const tinygltf::Primitive& primitive, const std::vector<glm::mat4>& joints,
                      const std::string& where, Geometry& geometry) {
  const std::size_t count = geometry.positions.size();
  const auto joint_of = accessors_.integers(attribute(primitive, "JOINTS_0"), 4);
  const auto weights = joint_of ? accessors_.floats(attribute(primitive, "WEIGHTS_0"), 4) : std::nullopt;
  if (!joint_of || !weights || joint_of->size() < 4 * count || weights->size() < 4 * count ||
      !accessors_.charge(count * 2 * sizeof(glm::vec3))) {
    builder_.warn(where + "its skin cannot be used: " +
                  (joint_of && weights ? "JOINTS_0 or WEIGHTS_0 is too short" : accessors_.problem()));
    return;
  }
  glm::vec3* positions = geometry.positions.mutable_data();
  glm::vec3* normals = geometry.normals.empty() ? nullptr : geometry.normals.mutable_data();
  for (std::size_t i = 0; i < count; ++i) {
    glm::mat4 matrix(0.0f);
    float sum = 0;
    for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) {
      const float weight = (*weights)[k];
      if (weight == 0 || (*joint_of)[k] >= joints.size()) continue;
      matrix += weight * joints[(*joint_of)[k]];
      sum += weight;
    }
    if (!(sum > 0)) continue;
    positions[i] = glm::vec3(matrix * glm::vec4(positions[i], 1.0f)) / sum;
    if (!normals) continue;
    const glm::vec3 turned = glm::mat3(matrix) * normals[i];
    const float length = glm::length(turned);
    if (length > 0) normals[i] = turned / length;
  }
}

}  // namespace gs::app
