#include "base/parallel.h"
#include "render/mesh/mesh_pass.h"
#include "render/text/system_fonts.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <span>

// Part of MeshPass that merges small texts into one draw. A draw call for each label would take longer than its few
// vertices.
namespace gs::render {
namespace {

/// Returns the normal of a flat mesh in camera space, towards the viewer. Transforms it as the vertex shader does.
glm::vec3 facing_normal(const vrml::Mesh& mesh, const float (&rows)[3][4], const glm::vec3& center) {
  glm::vec3 x(rows[0][0], rows[0][1], rows[0][2]), y(rows[1][0], rows[1][1], rows[1][2]),
      z(rows[2][0], rows[2][1], rows[2][2]);
  const glm::vec3 largest = glm::max(glm::max(glm::abs(x), glm::abs(y)), glm::abs(z));
  const float scale = 1 / std::max(std::max(std::max(largest.x, largest.y), largest.z), 1e-37f);
  x *= scale;
  y *= scale;
  z *= scale;
  const glm::vec3& normal = mesh.normals[0];
  const glm::vec3 n(glm::dot(glm::cross(y, z), normal), glm::dot(glm::cross(z, x), normal),
                    glm::dot(glm::cross(x, y), normal));
  const float length = std::sqrt(glm::dot(n, n));
  if (!(length > 0)) return {0, 0, 0};
  return glm::dot(n, center) > 0 ? n / -length : n / length;
}

}  // namespace

bool MeshPass::find_glyphs() {
  if (glyphs_) return true;
  glyph_picture_ = system_fonts().glyph_picture();
  glyphs_ = textures_.find_mask(glyph_picture_);
  return glyphs_ != nullptr;
}

/// Prepares a text with one colour in all pixels. Such a text needs no lights and no instance, and its mesh is not
/// uploaded. Returns false for other texts.
bool MeshPass::prepare_text(const DrawItem& item, const glm::vec3& center, float radius, const glm::vec3& origin,
                            Prepared& prepared) {
  const vrml::Mesh& mesh = *item.mesh;
  const Material& material = item.material;
  const std::size_t vertices = mesh.positions.size();
  if (material.transparency > 0 || (material.lit && mesh.lit && material.specular != glm::vec3(0))) return false;
  if (mesh.primitive != vrml::Mesh::Primitive::triangles || mesh.solid || vertices == 0 || !mesh.colors.empty() ||
      mesh.normals.size() != vertices || mesh.texture_coordinates.size() != vertices)
    return false;
  glm::vec3 color = !material.lit ? material.unlit : material.emissive;
  if (material.lit && mesh.lit) {
    const std::uint32_t lights = lights_.choose(item.directional_lights, center, radius);
    if (!lights_.directional_only(lights)) return false;
    color = lights_.color_of(lights, facing_normal(mesh, prepared.instance.camera_from_node, center), material.diffuse,
                             material.emissive, material.ambient_intensity);
  }
  if (!find_glyphs()) return true;
  DrawState& state = prepared.state;
  state.variant = kTexture | kCutOut | kMask | (fog_.on ? kFog : 0u) | (several_samples_ ? kSmoothEdges : 0u);
  state.texture = texture_number({}, *glyphs_);
  if (!program(state.variant)) return true;
  for (int i = 0; i < 3; ++i) prepared.instance.base_color[i] = color[i];
  prepared.mesh = &mesh;
  prepared.origin = origin;
  const std::uint32_t layer = filled_.layer_of(center, radius, state.packed());
  opaque_.push_back({layer, state.packed(), kMergedMesh, -center.z, static_cast<std::uint32_t>(prepared_.size())});
  prepared_.push_back(prepared);
  return true;
}

/// Writes the triangles of a text in camera space to its place in the vertices and indices.
void MeshPass::add_text(const TextPlace& place) {
  const Prepared& prepared = prepared_[place.prepared];
  const vrml::Mesh& mesh = *prepared.mesh;
  const std::size_t count = mesh.positions.size(), corners = mesh.indices.size();
  const glm::vec3* positions = mesh.positions.data();
  const glm::vec2* places = mesh.texture_coordinates.data();
  // Copy the row: the compiler must assume that writing floats changes members.
  const auto row = [&](int axis) {
    const auto& r = prepared.instance.camera_from_node[axis];
    return glm::vec4(r[0], r[1], r[2], r[3]);
  };
  const glm::vec4 x = row(0), y = row(1), z = row(2);
  const auto& base = prepared.instance.base_color;
  const glm::vec3 color(base[0], base[1], base[2]), origin = prepared.origin;
  MeshStore::StreamedVertex* to = text_vertices_.data() + place.vertex;
  for (std::size_t i = 0; i < count; ++i, ++to) {
    const glm::vec3 p = positions[i] - origin;
    *to = {{x.x * p.x + x.y * p.y + x.z * p.z + x.w, y.x * p.x + y.y * p.y + y.z * p.z + y.w,
            z.x * p.x + z.y * p.y + z.z * p.z + z.w},
           {places[i].x, places[i].y},
           {color.x, color.y, color.z}};
  }
  const auto first = static_cast<std::uint32_t>(place.vertex);
  const std::uint32_t* from = mesh.indices.data();
  std::uint32_t* index = text_indices_.data() + place.index;
  for (std::size_t i = 0; i < corners; ++i) index[i] = first + from[i];
}

/// Transforms the triangles of the merged texts to camera space. Makes one slice per layer and state, nearest text
/// first. Appends one identity instance for all slices.
void MeshPass::merge_texts() {
  text_vertex_count_ = text_index_count_ = 0;
  text_slices_.clear();
  text_places_.clear();
  for (std::size_t begin = 0; begin < opaque_.size();) {
    const SortKey& first = opaque_[begin];
    if (first.mesh != kMergedMesh) {
      ++begin;
      continue;
    }
    MeshStore::Slice slice;
    slice.streamed = slice.colors = slice.texture_coordinates = true;
    slice.first_index = text_index_count_;
    std::size_t end = begin;
    while (end < opaque_.size() && opaque_[end].mesh == kMergedMesh && opaque_[end].state == first.state &&
           opaque_[end].layer == first.layer) {
      const std::uint32_t number = opaque_[end++].prepared;
      text_places_.push_back({number, text_vertex_count_, text_index_count_});
      text_vertex_count_ += prepared_[number].mesh->positions.size();
      text_index_count_ += prepared_[number].mesh->indices.size();
    }
    slice.index_count = static_cast<GLsizei>(text_index_count_ - slice.first_index);
    text_slices_.push_back(slice);
    begin = end;
  }
  if (text_slices_.empty()) return;
  const auto room = [](auto& list, std::size_t size) {
    if (list.size() < size) list.resize(std::max(size, 2 * list.size()));
  };
  room(text_vertices_, text_vertex_count_);
  room(text_indices_, text_index_count_);
  constexpr std::size_t kTexts = 512;  // texts per task
  (void)parallel_for((text_places_.size() + kTexts - 1) / kTexts, [&](std::size_t task) {
    for (const TextPlace& place :
         std::span(text_places_).subspan(task * kTexts, std::min(kTexts, text_places_.size() - task * kTexts)))
      add_text(place);
  });
  Instance still{};
  for (int axis = 0; axis < 3; ++axis) still.camera_from_node[axis][axis] = 1;
  still.alpha = 1;
  instances_.push_back(still);
  std::size_t run = 0;
  for (std::size_t i = 0; i < opaque_.size(); ++i) {
    const SortKey& key = opaque_[i];
    if (key.mesh != kMergedMesh) continue;
    const bool same = i > 0 && opaque_[i - 1].mesh == kMergedMesh && opaque_[i - 1].state == key.state &&
                      opaque_[i - 1].layer == key.layer;
    if (!same) prepared_[key.prepared].slice = &text_slices_[run++];
  }
  meshes_.set_streamed(std::span(text_vertices_).first(text_vertex_count_),
                       std::span(text_indices_).first(text_index_count_));
}

}  // namespace gs::render
