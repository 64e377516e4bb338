#pragma once

#include "render/rays/box_tree.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace gs::render {

/// Hit of a line on a triangle of a mesh.
struct TriangleHit {
  double distance = 0;  // multiple of the length of the line's direction
  std::uint32_t triangle = 0;  // index of the triangle; its corners are indices[3 * triangle] and the next two
  glm::dvec3 weights{0};  // barycentric coordinates of the hit: each from 0 to 1, sum 1
};

/// Bounding volume hierarchy of a mesh's triangles. Takes about 20 bytes per triangle, and 32 more while it is built.
/// Building takes about half a second per million triangles. Ignores triangles with corners that are not finite. Does
/// not hold the mesh.
class MeshBvh {
 public:
  explicit MeshBvh(const vrml::Mesh& mesh);

  /// Returns the nearest hit, from either side. At equal distances, returns the first triangle. `mesh` must be the mesh
  /// from which the tree was built. `line` is in the mesh's space.
  [[nodiscard]] std::optional<TriangleHit> nearest(const vrml::Mesh& mesh, const SightLine& line) const;
  /// Calls `meet(triangle)` for triangles that may touch the box from `lower` to `upper`, in the mesh's space. Stops if
  /// `meet` returns false.
  template <class Meet>
  void near(const vrml::Mesh& mesh, const glm::dvec3& lower, const glm::dvec3& upper, const Meet& meet) const;
  [[nodiscard]] std::size_t bytes() const { return tree_.bytes(); }

 private:
  static constexpr std::size_t kFewTriangles = 32;  // meshes with at most this number of triangles need no tree

  BoxTree tree_;  // empty if the mesh has few triangles
};

/// Finds the nearest hit by testing all triangles.
[[nodiscard]] std::optional<TriangleHit> nearest_of_all(const vrml::Mesh& mesh, const SightLine& line);

template <class Meet>
void MeshBvh::near(const vrml::Mesh& mesh, const glm::dvec3& lower, const glm::dvec3& upper, const Meet& meet) const {
  const std::size_t triangles = mesh.indices.size() / 3;
  if (triangles > kFewTriangles) return tree_.visit(lower, upper, meet);
  for (std::uint32_t i = 0; i < triangles; ++i)
    if (!meet(i)) return;
}

}  // namespace gs::render
