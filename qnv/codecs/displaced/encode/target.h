#pragma once

#include "base/noncopyable.h"
#include "qnv/mesh/manifold.h"
#include "qnv/mesh/triangle_tree.h"

#include <glm/vec3.hpp>

#include <cstdint>

namespace gs::qnv::displaced {

/// Surface that an encoder approximates, with its search structures. All coordinates are in a Frame.
class Target : NonCopyable {
 public:
  /// `mesh` must outlive this object. `beside` holds the neighbours of the mesh's triangles. Uses `threads` threads (0
  /// means one per core).
  Target(const SurfaceMesh& mesh, const Neighbours& beside, unsigned threads);

  [[nodiscard]] const SurfaceMesh& mesh() const { return mesh_; }
  /// Returns the mean edge length.
  [[nodiscard]] float edge() const { return edge_; }
  /// Returns the signed distance along `normal` from a point to the smooth surface. Returns 0 if the surface is farther
  /// than `reach`. `triangle` caches the triangle that was hit, for queries nearby; start with kNone.
  [[nodiscard]] float distance(const glm::vec3& from, const glm::vec3& normal, float reach,
                               std::uint32_t& triangle) const;
  /// Returns the nearest point on a rim or crease. Its triangle is kNone if no such point is within `reach`.
  [[nodiscard]] SurfacePoint line(const glm::vec3& from, float reach) const;
  /// Returns the colour of the surface at its nearest point.
  [[nodiscard]] glm::vec3 color(const glm::vec3& from, const glm::vec3& normal, float reach) const;

 private:
  const SurfaceMesh& mesh_;
  SurfaceMesh lines_;
  TriangleTree tree_, line_tree_;
  float edge_ = 0;
};

}  // namespace gs::qnv::displaced
