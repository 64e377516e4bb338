#pragma once

#include "qnv/base/cloud.h"
#include "qnv/displaced/centre.h"
#include "qnv/displaced/manifold.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// A place on a surface.
struct SurfacePoint {
  std::uint32_t triangle = kNone;  // kNone: there is none
  glm::vec3 position{0};
  float distance = std::numeric_limits<float>::infinity();  // from where it was looked for; along a line: signed
};

/// The triangles of a mesh in a tree of boxes. Does not change; any number of threads may ask.
class TriangleTree {
 public:
  /// The mesh must stay. Built on `threads` threads (0: one a core).
  explicit TriangleTree(const SurfaceMesh& mesh, unsigned threads = 0);

  /// Where the line through `from` along +-`direction` (of length 1) meets the surface nearest to `from`, within
  /// `reach`, on a triangle whose normal is within `least` (a cosine) of `facing`.
  [[nodiscard]] SurfacePoint along(const glm::vec3& from, const glm::vec3& direction, float reach,
                                   const glm::vec3& facing, float least) const;
  /// Where that line meets one triangle, if it does within `reach`.
  [[nodiscard]] SurfacePoint on(std::uint32_t triangle, const glm::vec3& from, const glm::vec3& direction,
                                float reach) const;
  /// The nearest place of the surface within `reach`, on a triangle whose normal is within `least` of `facing`.
  [[nodiscard]] SurfacePoint nearest(const glm::vec3& from, float reach, const glm::vec3& facing, float least) const;
  /// How much of each corner a place of a triangle has; in sum 1.
  [[nodiscard]] glm::vec3 weights(const SurfacePoint& point) const;
  /// Where the smooth surface lies that shading makes of the triangle round a place of it: on a curve that leaves its
  /// corners at right angles to their normals. Without normals, the place itself.
  [[nodiscard]] glm::vec3 smooth(const SurfacePoint& point) const;

 private:
  using Four = float __attribute__((vector_size(16)));
  /// Up to four children. No count: a node; no triangles at all: a box that nothing meets.
  struct Node {
    std::array<Four, 3> lower, upper;
    std::array<std::uint32_t, 4> first, count;  // the node, or the leaf
  };
  /// Up to four triangles.
  struct Leaf {
    std::array<Four, 3> a, ab, ac, normal;  // a corner, from it to the others; unit, or zero where there is no area
    std::array<std::uint32_t, 4> triangle;
  };
  /// Triangles that a node is to have, and where it, what lies below it, and its leaves stand.
  struct Part {
    std::uint32_t first, count, node, leaf;
  };
  struct Size {
    std::uint32_t nodes, leaves;
  };
  Size size_of(std::uint32_t count);
  [[nodiscard]] Size known_size(std::uint32_t count) const;
  void halve(std::vector<Centre>& centres, std::uint32_t first, std::uint32_t count) const;
  void split(std::vector<Centre>& centres, const Part& part, std::vector<Part>& below);
  void add_leaf(const std::vector<Centre>& centres, const Part& part, Node& parent, std::size_t slot);

  const SurfaceMesh& mesh_;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  std::map<std::uint32_t, Size> sizes_;  // of a tree of so many triangles
};

}  // namespace gs::qnv::displaced
