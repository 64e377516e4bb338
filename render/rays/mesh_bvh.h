#pragma once

#include "render/rays/box_tree.h"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace gs::render {

/// Where a line meets a triangle of a mesh.
struct TriangleHit {
  double distance = 0;         // in lengths of the line's direction
  std::uint32_t triangle = 0;  // of the mesh: its corners are indices[3 * triangle] and the two behind it
  glm::dvec3 weights{0};       // of the corners; 0 to 1, their sum is 1
};

/// The triangles of a mesh, so that few of them have to be looked at for a line: about 20 bytes a triangle, and for a
/// moment 32 more while it is made, in about half a second a million. Triangles with corners that are no numbers are
/// left out. A plain value; it does not hold the mesh.
class MeshBvh {
 public:
  explicit MeshBvh(const vrml::Mesh& mesh);

  /// The nearest triangle, from either side; of several at the same distance the first one. `mesh` must be the same,
  /// of triangles, and `line` in its space.
  [[nodiscard]] std::optional<TriangleHit> nearest(const vrml::Mesh& mesh, const SightLine& line) const;
  /// Calls `meet(triangle)` for triangles that may touch the box `lower` to `upper` of the mesh's space, until it
  /// returns false.
  template <class Meet>
  void near(const vrml::Mesh& mesh, const glm::dvec3& lower, const glm::dvec3& upper, const Meet& meet) const;
  [[nodiscard]] std::size_t bytes() const { return tree_.bytes(); }

 private:
  static constexpr std::size_t kFewTriangles = 32;  // are looked at all

  BoxTree tree_;  // none for a few triangles
};

/// The same by looking at all of them.
[[nodiscard]] std::optional<TriangleHit> nearest_of_all(const vrml::Mesh& mesh, const SightLine& line);

template <class Meet>
void MeshBvh::near(const vrml::Mesh& mesh, const glm::dvec3& lower, const glm::dvec3& upper, const Meet& meet) const {
  const std::size_t triangles = mesh.indices.size() / 3;
  if (triangles > kFewTriangles) return tree_.visit(lower, upper, meet);
  for (std::uint32_t i = 0; i < triangles; ++i)
    if (!meet(i)) return;
}

}  // namespace gs::render
