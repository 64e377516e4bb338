#pragma once

#include "vrml/mesh/mesh.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::vrml::test {

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr Color kRed{1, 0, 0}, kGreen{0, 1, 0}, kBlue{0, 0, 1};

/// Scene with one geometry node and the nodes of its fields.
struct GeometryScene {
  std::unique_ptr<SceneGraph> owner = std::make_unique<SceneGraph>();  // makes this movable
  SceneGraph& scene = *owner;
  Language language = Language::vrml97;
  NodeId geometry;

  explicit GeometryScene(std::string_view type, Language of = Language::vrml97) : language(of), geometry(make(type)) {}

  NodeId make(std::string_view type) {
    const NodeType* found = built_in_node_type(language, type);
    REQUIRE(found != nullptr);
    return scene.create(*found);
  }
  /// Makes an instance of a PROTO with the body `body`.
  NodeId instance_of(NodeId body) {
    auto type = std::make_unique<NodeType>();
    type->name = "Wrapper";
    type->kind = NodeType::Kind::prototype;
    const NodeId instance = scene.create(scene.add_type(std::move(type)));
    scene.node(instance).expansion = MFNode{body};
    return instance;
  }
  template <class T>
  GeometryScene& set(std::string_view field, T value) {
    scene.set<T>(geometry, field, std::move(value));
    return *this;
  }
  GeometryScene& points(MFVec3f values) { return property("coord", "Coordinate", "point", std::move(values)); }
  GeometryScene& normals(MFVec3f values) { return property("normal", "Normal", "vector", std::move(values)); }
  GeometryScene& colors(MFColor values) { return property("color", "Color", "color", std::move(values)); }
  GeometryScene& texture(MFVec2f values) {
    return property("texCoord", "TextureCoordinate", "point", std::move(values));
  }
  template <class T>
  GeometryScene& property(std::string_view field, std::string_view type, std::string_view values_field, T values) {
    const NodeId node = make(type);
    scene.set<T>(node, values_field, std::move(values));
    scene.set<SFNode>(geometry, field, node);
    return *this;
  }
  [[nodiscard]] Mesh mesh(const MeshOptions& options = {}) const { return tessellate(scene, geometry, options); }
};

[[nodiscard]] inline std::size_t corners_of(Mesh::Primitive primitive) {
  switch (primitive) {
    case Mesh::Primitive::triangles:
      return 3;
    case Mesh::Primitive::lines:
      return 2;
    case Mesh::Primitive::points:
      return 1;
  }
  return 1;
}

/// Checks the guarantees of mesh.h.
inline void check_promises(const Mesh& mesh, bool exact_bounds = true) {
  REQUIRE(mesh.indices.size() % corners_of(mesh.primitive) == 0);
  const std::size_t count = mesh.positions.size();
  REQUIRE((mesh.normals.empty() || mesh.normals.size() == count));
  REQUIRE((mesh.colors.empty() || mesh.colors.size() == count));
  REQUIRE((mesh.texture_coordinates.empty() || mesh.texture_coordinates.size() == count));
  Box bounds;
  bool in_range = true, finite = true, unit = true;
  for (const std::uint32_t index : mesh.indices) {
    in_range &= index < count;
    if (!in_range) break;
    const glm::vec3& p = mesh.positions[index];
    finite &= std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
    bounds.add(p);
    if (!mesh.normals.empty()) unit &= std::abs(glm::length(mesh.normals[index]) - 1) < 0.01f;
  }
  REQUIRE(in_range);
  REQUIRE(finite);
  REQUIRE(unit);
  REQUIRE(mesh.bounds.empty() == mesh.indices.empty());
  if (!bounds.empty()) {
    // The bounds may include corners of a concave face that have no triangle.
    Box joined = mesh.bounds;
    joined.add(bounds);
    REQUIRE(joined.lower == mesh.bounds.lower);
    REQUIRE(joined.upper == mesh.bounds.upper);
    if (exact_bounds) REQUIRE(mesh.bounds.lower == bounds.lower);
    if (exact_bounds) REQUIRE(mesh.bounds.upper == bounds.upper);
  }
}

[[nodiscard]] inline glm::dvec3 corner(const Mesh& mesh, std::size_t i) {
  return glm::dvec3(mesh.positions[mesh.indices[i]]);
}
/// Returns twice the area vector of triangle `t`.
[[nodiscard]] inline glm::dvec3 area_vector(const Mesh& mesh, std::size_t t) {
  const glm::dvec3 a = corner(mesh, 3 * t);
  return glm::cross(corner(mesh, 3 * t + 1) - a, corner(mesh, 3 * t + 2) - a);
}
[[nodiscard]] inline std::size_t triangles_of(const Mesh& mesh) { return mesh.indices.size() / 3; }
[[nodiscard]] inline double area_of(const Mesh& mesh) {
  double area = 0;
  for (std::size_t t = 0; t < triangles_of(mesh); ++t) area += glm::length(area_vector(mesh, t)) / 2;
  return area;
}
/// Returns the volume, positive for a closed surface that is counter-clockwise seen from outside.
[[nodiscard]] inline double volume_of(const Mesh& mesh) {
  double volume = 0;
  for (std::size_t t = 0; t < triangles_of(mesh); ++t)
    volume += glm::dot(corner(mesh, 3 * t), area_vector(mesh, t)) / 6;
  return volume;
}
/// Reports whether all normals are on the front of their triangles.
[[nodiscard]] inline bool normals_on_front(const Mesh& mesh) {
  for (std::size_t t = 0; t < triangles_of(mesh); ++t)
    for (std::size_t i = 3 * t; i < 3 * t + 3; ++i)
      if (glm::dot(area_vector(mesh, t), glm::dvec3(mesh.normals[mesh.indices[i]])) < -1e-9) return false;
  return true;
}
/// Returns the texture coordinate at a position with this normal. Fails if there is none.
[[nodiscard]] inline glm::vec2 texture_at(const Mesh& mesh, glm::vec3 position, glm::vec3 normal) {
  for (const std::uint32_t i : mesh.indices)
    if (glm::length(mesh.positions[i] - position) < 1e-4f && glm::dot(mesh.normals[i], normal) > 0.9f)
      return mesh.texture_coordinates[i];
  FAIL("no vertex at " << position.x << ' ' << position.y << ' ' << position.z);
  return {};
}
[[nodiscard]] inline bool near(glm::vec3 a, glm::vec3 b, float tolerance = 1e-5f) {
  return glm::length(a - b) < tolerance;
}
[[nodiscard]] inline bool near(glm::vec2 a, glm::vec2 b, float tolerance = 1e-5f) {
  return glm::length(a - b) < tolerance;
}

/// Corners of a cube of side 2 around the origin, and its six faces, counter-clockwise from outside.
[[nodiscard]] inline MFVec3f cube_points() {
  return {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
}
[[nodiscard]] inline MFInt32 cube_faces() {
  return {0, 3, 2, 1, -1, 4, 5, 6, 7, -1, 0, 1, 5, 4, -1, 1, 2, 6, 5, -1, 2, 3, 7, 6, -1, 3, 0, 4, 7, -1};
}

}  // namespace gs::vrml::test
