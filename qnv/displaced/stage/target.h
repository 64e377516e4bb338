#pragma once

#include "qnv/displaced/manifold.h"
#include "qnv/displaced/triangle_tree.h"

#include <glm/vec3.hpp>

#include <cstdint>

namespace gs::qnv::displaced {

/// The surface that a stream stands for, as encoders look at it, in a Frame, like all that follows.
class Target {
 public:
  /// The mesh must stay. `beside`: of its triangles. Made on `threads` threads (0: one a core).
  Target(const SurfaceMesh& mesh, const Neighbours& beside, unsigned threads);
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  [[nodiscard]] const SurfaceMesh& mesh() const { return mesh_; }
  /// Mean length of an edge.
  [[nodiscard]] float edge() const { return edge_; }
  /// How far along `normal` the smooth surface lies from a place; 0 where it is not found within `reach`. `triangle`:
  /// on which it was found, for the next question from a place beside this one; kNone at first.
  [[nodiscard]] float distance(const glm::vec3& from, const glm::vec3& normal, float reach,
                               std::uint32_t& triangle) const;
  /// The nearest place of a rim or of an edge whose sides are shaded apart; none within `reach`: kNone.
  [[nodiscard]] SurfacePoint line(const glm::vec3& from, float reach) const;
  /// The colour of the nearest place.
  [[nodiscard]] glm::vec3 color(const glm::vec3& from, const glm::vec3& normal, float reach) const;

 private:
  const SurfaceMesh& mesh_;
  SurfaceMesh lines_;
  TriangleTree tree_, line_tree_;
  float edge_ = 0;
};

}  // namespace gs::qnv::displaced
