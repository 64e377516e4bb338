#pragma once

#include "render/rays/box_tree.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace gs::render {

/// Hit of a line on a triangle of a mesh.
struct TriangleHit {
  double distance = 0;         // in lengths of the line's direction
  std::uint32_t triangle = 0;  // triangle index: its corners are at indices[3 * triangle] and the next two
  glm::dvec3 weights{0};       // barycentric, each 0 to 1, sum 1
};

/// Bounding volume hierarchy of a mesh's triangles. Takes about 20 bytes per triangle, plus 32 while it is built in
/// about half a second per million. Ignores triangles with non-finite corners. A plain value that does not hold the
/// mesh.
class MeshBvh {
 public:
  explicit MeshBvh(const vrml::Mesh& mesh);

  /// Returns the nearest triangle from either side; at equal distance, the first one. `mesh` must be the triangle mesh
  /// that the tree was built from; `line` is in its space.
  [[nodiscard]] std::optional<TriangleHit> nearest(const vrml::Mesh& mesh, const SightLine& line) const;
  /// Calls `meet(triangle)` for triangles that may touch the box `lower` to `upper` in mesh space, until it returns
  /// false.
  template <class Meet>
  void near(const vrml::Mesh& mesh, const glm::dvec3& lower, const glm::dvec3& upper, const Meet& meet) const;
  [[nodiscard]] std::size_t bytes() const { return tree_.bytes(); }

 private:
  static constexpr std::size_t kFewTriangles = 32;  // meshes up to this size are searched linearly

  BoxTree tree_;  // empty for few triangles
};

/// Finds the nearest triangle by linear search.
[[nodiscard]] std::optional<TriangleHit> nearest_of_all(const vrml::Mesh& mesh, const SightLine& line);

template <class Meet>
void MeshBvh::near(const vrml::Mesh& mesh, const glm::dvec3& lower, const glm::dvec3& upper, const Meet& meet) const {
  const std::size_t triangles = mesh.indices.size() / 3;
  if (triangles > kFewTriangles) return tree_.visit(lower, upper, meet);
  for (std::uint32_t i = 0; i < triangles; ++i)
    if (!meet(i)) return;
}

}  // namespace gs::render
