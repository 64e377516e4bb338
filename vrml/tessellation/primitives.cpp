#include "vrml/tessellation/properties.h"
#include "vrml/tessellation/tessellators.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::vrml {
namespace {

constexpr int kMaximumSegments = 4096;

[[nodiscard]] bool is_size(float value) { return std::isfinite(value) && value > 0; }
/// Accepts 0, which is drawn flat, although the ranges in the node table exclude it.
[[nodiscard]] bool is_size_or_flat(float value) { return std::isfinite(value) && value >= 0; }

/// Returns a measure of the node. If MeshOptions::default_measures is set, returns the default of the node's type.
template <class T>
[[nodiscard]] T measure(const SceneGraph& scene, NodeId geometry, std::string_view field, const MeshOptions& options) {
  if (!options.default_measures) return scene.get<T>(geometry, field);
  const NodeType& type = *scene.node(geometry).type;
  return std::get<T>(type.defaults[static_cast<std::size_t>(type.find_field(field)->slot)]);
}

/// Returns a measure of the node divided by its type's default.
template <class T>
[[nodiscard]] T relative(const SceneGraph& scene, NodeId geometry, std::string_view field) {
  return scene.get<T>(geometry, field) / measure<T>(scene, geometry, field, {.default_measures = true});
}

/// Unit vector in the XZ plane.
struct Direction {
  float x, z;
};

/// Returns segments + 1 directions that turn once around the Y axis, counter-clockwise seen from above. They start at
/// the texture seam at the back (-Z; VRML97 6.11, 6.14, 6.43).
[[nodiscard]] std::vector<Direction> turn(int segments) {
  std::vector<Direction> directions(static_cast<std::size_t>(segments) + 1);
  for (int i = 0; i < segments; ++i) {
    const double angle = 2 * std::numbers::pi * i / segments;
    directions[static_cast<std::size_t>(i)] = {static_cast<float>(-std::sin(angle)),
                                               static_cast<float>(-std::cos(angle))};
  }
  directions.back() = directions.front();  // makes the turn exactly closed
  return directions;
}

[[nodiscard]] int segments_of(const MeshOptions& options) { return std::clamp(options.segments, 3, kMaximumSegments); }

/// Builder that collects the parts of a primitive of known size.
class Builder {
 public:
  /// Reserves memory for at most this number of vertices and triangles.
  Builder(std::size_t vertices, std::size_t triangles)
      : position_(mesh_.positions.prepare(vertices)),
        normal_(mesh_.normals.prepare(vertices)),
        coordinate_(mesh_.texture_coordinates.prepare(vertices)),
        index_(mesh_.indices.prepare(3 * triangles)) {}

  std::uint32_t vertex(glm::vec3 position, glm::vec3 normal, glm::vec2 texture_coordinate) {
    position_[vertices_] = position;
    normal_[vertices_] = normal;
    coordinate_[vertices_] = texture_coordinate;
    return vertices_++;
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    index_[0] = a;
    index_[1] = b;
    index_[2] = c;
    index_ += 3;
    ++triangles_;
  }
  [[nodiscard]] Mesh finish() {
    if (triangles_ == 0) return {};
    mesh_.convex = true;
    mesh_.positions.commit(vertices_);
    mesh_.normals.commit(vertices_);
    mesh_.texture_coordinates.commit(vertices_);
    mesh_.indices.commit(3 * triangles_);
    for (const glm::vec3& position : mesh_.positions) mesh_.bounds.add(position);
    return std::move(mesh_);
  }

 private:
  Mesh mesh_;
  glm::vec3 *position_, *normal_;
  glm::vec2* coordinate_;
  std::uint32_t* index_;
  std::uint32_t vertices_ = 0;
  std::size_t triangles_ = 0;
};

/// Adds a disc at the height `y`. If `up`, the disc faces up, and its texture is upright after the top of the body is
/// tilted towards +Z. Otherwise the disc faces down, and the texture is upright after a tilt towards -Z (VRML97 6.11,
/// 6.14).
void add_disc(Builder& builder, const std::vector<Direction>& around, float radius, float y, bool up) {
  const float sign = up ? 1.0f : -1.0f;
  const glm::vec3 normal(0, sign, 0);
  const std::uint32_t center = builder.vertex({0, y, 0}, normal, {0.5f, 0.5f});
  const auto segments = static_cast<std::uint32_t>(around.size() - 1);
  for (std::uint32_t i = 0; i < segments; ++i)
    builder.vertex({radius * around[i].x, y, radius * around[i].z}, normal,
                   {0.5f + 0.5f * around[i].x, 0.5f - sign * 0.5f * around[i].z});
  for (std::uint32_t i = 0; i < segments; ++i) {
    const std::uint32_t a = center + 1 + i, b = center + 1 + (i + 1) % segments;
    up ? builder.triangle(center, a, b) : builder.triangle(center, b, a);
  }
}

/// Measures of a cone or cylinder, and the directions around its axis.
struct RoundSolid {
  float radius, height, half;  // `half` of the height
  int segments;
  std::vector<Direction> around;
};
RoundSolid round_solid(const SceneGraph& scene, NodeId geometry, std::string_view radius, const MeshOptions& options) {
  const auto height = measure<SFFloat>(scene, geometry, "height", options);
  const int segments = segments_of(options);
  return {measure<SFFloat>(scene, geometry, radius, options), height, height * 0.5f, segments, turn(segments)};
}

/// Returns the finished mesh. Only X3D types have the field `solid`.
[[nodiscard]] Mesh finish(Builder& builder, const SceneGraph& scene, NodeId geometry) {
  Mesh mesh = builder.finish();
  mesh.solid = field_or(scene, geometry, "solid", true);
  return mesh;
}

}  // namespace

Mesh tessellate_box(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto size = measure<SFVec3f>(scene, geometry, "size", options);
  if (!is_size_or_flat(size.x) || !is_size_or_flat(size.y) || !is_size_or_flat(size.z)) return {};
  const glm::vec3 half = size * 0.5f;

  // Face of a box: its normal, and the directions of s and t on it (VRML97 6.7).
  struct Face {
    glm::vec3 normal, right, up;
  };
  static constexpr Face kFaces[] = {
      {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}, {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
      {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},  {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
  };
  Builder builder(24, 12);
  const auto has_length = [&](const glm::vec3& direction) { return size * direction != glm::vec3(0); };
  for (const Face& face : kFaces) {
    if (!has_length(face.right) || !has_length(face.up)) continue;
    const std::uint32_t a = builder.vertex(half * (face.normal - face.right - face.up), face.normal, {0, 0});
    const std::uint32_t b = builder.vertex(half * (face.normal + face.right - face.up), face.normal, {1, 0});
    const std::uint32_t c = builder.vertex(half * (face.normal + face.right + face.up), face.normal, {1, 1});
    const std::uint32_t d = builder.vertex(half * (face.normal - face.right + face.up), face.normal, {0, 1});
    builder.triangle(a, b, c);
    builder.triangle(a, c, d);
  }
  return finish(builder, scene, geometry);
}

Mesh tessellate_cone(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto [radius, height, half, segments, around] = round_solid(scene, geometry, "bottomRadius", options);
  if (!is_size(radius) || !is_size_or_flat(height)) return {};  // a cone without a radius would be a line

  Builder builder(3 * around.size(), 2 * around.size());
  if (scene.get<SFBool>(geometry, "side")) {
    const double slant = std::hypot(static_cast<double>(radius), static_cast<double>(height));
    const auto outwards = static_cast<float>(height / slant);
    const auto upwards = static_cast<float>(radius / slant);
    // Adds two vertices per segment: one on the rim, and the apex with the normal at the middle of the segment.
    for (int i = 0; i <= segments; ++i) {
      const Direction rim = around[static_cast<std::size_t>(i)];
      const float s = static_cast<float>(i) / static_cast<float>(segments);
      builder.vertex({radius * rim.x, -half, radius * rim.z}, {outwards * rim.x, upwards, outwards * rim.z}, {s, 0});
      const double middle = 2 * std::numbers::pi * (i + 0.5) / segments;
      const glm::vec3 normal(outwards * static_cast<float>(-std::sin(middle)), upwards,
                             outwards * static_cast<float>(-std::cos(middle)));
      if (i < segments) builder.vertex({0, half, 0}, normal, {s + 0.5f / static_cast<float>(segments), 1});
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(segments); ++i)
      builder.triangle(2 * i, 2 * i + 2, 2 * i + 1);
  }
  if (scene.get<SFBool>(geometry, "bottom")) add_disc(builder, around, radius, -half, false);
  return finish(builder, scene, geometry);
}

Mesh tessellate_cylinder(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto [radius, height, half, segments, around] = round_solid(scene, geometry, "radius", options);
  if (!is_size(radius) || !is_size_or_flat(height)) return {};  // a cylinder without a radius would be a line

  Builder builder(4 * around.size(), 4 * around.size());
  if (height > 0 && scene.get<SFBool>(geometry, "side")) {
    for (int i = 0; i <= segments; ++i) {
      const Direction rim = around[static_cast<std::size_t>(i)];
      const float s = static_cast<float>(i) / static_cast<float>(segments);
      builder.vertex({radius * rim.x, -half, radius * rim.z}, {rim.x, 0, rim.z}, {s, 0});
      builder.vertex({radius * rim.x, half, radius * rim.z}, {rim.x, 0, rim.z}, {s, 1});
    }
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(segments); ++i) {
      builder.triangle(2 * i, 2 * i + 2, 2 * i + 3);
      builder.triangle(2 * i, 2 * i + 3, 2 * i + 1);
    }
  }
  if (scene.get<SFBool>(geometry, "top")) add_disc(builder, around, radius, half, true);
  if (scene.get<SFBool>(geometry, "bottom")) add_disc(builder, around, radius, -half, false);
  return finish(builder, scene, geometry);
}

Mesh tessellate_sphere(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const auto radius = measure<SFFloat>(scene, geometry, "radius", options);
  if (!is_size(radius)) return {};
  const int segments = segments_of(options);
  const int stacks = std::max(2, segments / 2);
  const std::vector<Direction> around = turn(segments);
  const auto columns = static_cast<std::uint32_t>(segments) + 1;

  // Adds rows from the south pole up. A pole has one vertex per segment, with the texture coordinate at the middle of
  // the segment.
  Builder builder(columns * (static_cast<std::size_t>(stacks) + 1), 2 * columns * static_cast<std::size_t>(stacks));
  for (int row = 0; row <= stacks; ++row) {
    const bool pole = row == 0 || row == stacks;
    const double latitude = std::numbers::pi * (static_cast<double>(row) / stacks - 0.5);
    const auto y = pole ? (row == 0 ? -1.0f : 1.0f) : static_cast<float>(std::sin(latitude));
    const auto ring = pole ? 0.0f : static_cast<float>(std::cos(latitude));
    const float t = static_cast<float>(row) / static_cast<float>(stacks);
    for (std::uint32_t i = 0; i < columns; ++i) {
      const glm::vec3 normal(ring * around[i].x, y, ring * around[i].z);
      const float s = (static_cast<float>(i) + (pole ? 0.5f : 0.0f)) / static_cast<float>(segments);
      builder.vertex(normal * radius, normal, {std::min(s, 1.0f), t});
    }
  }
  for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(stacks); ++row)
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = row * columns + i, b = a + columns;
      if (row != 0) builder.triangle(a, a + 1, row + 1 == static_cast<std::uint32_t>(stacks) ? b : b + 1);
      if (row + 1 != static_cast<std::uint32_t>(stacks)) builder.triangle(a, b + 1, b);
    }
  return finish(builder, scene, geometry);
}

glm::vec3 scale_of_box(const SceneGraph& scene, NodeId geometry) { return relative<SFVec3f>(scene, geometry, "size"); }

glm::vec3 scale_of_cone(const SceneGraph& scene, NodeId geometry) {
  const float radius = relative<SFFloat>(scene, geometry, "bottomRadius");
  return {radius, relative<SFFloat>(scene, geometry, "height"), radius};
}

glm::vec3 scale_of_cylinder(const SceneGraph& scene, NodeId geometry) {
  const float radius = relative<SFFloat>(scene, geometry, "radius");
  return {radius, relative<SFFloat>(scene, geometry, "height"), radius};
}

glm::vec3 scale_of_sphere(const SceneGraph& scene, NodeId geometry) {
  return glm::vec3(relative<SFFloat>(scene, geometry, "radius"));
}

std::optional<glm::vec3> scale_of_primitive(const SceneGraph& scene, NodeId geometry) {
  const NodeId id = scene.resolve(geometry);
  const MeasuredScale scale_of = id ? scene.node(id).type->tessellator.scale : nullptr;
  if (!scale_of) return std::nullopt;
  const glm::vec3 scale = scale_of(scene, id);
  if (!is_size(scale.x) || !is_size(scale.y) || !is_size(scale.z)) return std::nullopt;
  return scale;
}

}  // namespace gs::vrml
