#pragma once

#include "qnv/base/cloud.h"
#include "qnv/displaced/manifold.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
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
  /// The mesh must stay.
  explicit TriangleTree(const SurfaceMesh& mesh);

  /// Where the line through `from` along +-`direction` (of length 1) meets the surface nearest to `from`, within
  /// `reach`, on a triangle whose normal is within `least` (a cosine) of `facing`.
  [[nodiscard]] SurfacePoint along(const glm::vec3& from, const glm::vec3& direction, float reach,
                                   const glm::vec3& facing, float least) const;
  /// The nearest place of the surface within `reach`, on a triangle whose normal is within `least` of `facing`.
  [[nodiscard]] SurfacePoint nearest(const glm::vec3& from, float reach, const glm::vec3& facing, float least) const;
  /// How much of each corner a place of a triangle has; in sum 1.
  [[nodiscard]] glm::vec3 weights(const SurfacePoint& point) const;
  /// Where the smooth surface lies that shading makes of the triangle round a place of it: on a curve that leaves its
  /// corners at right angles to their normals. Without normals, the place itself.
  [[nodiscard]] glm::vec3 smooth(const SurfacePoint& point) const;
  /// Unit; zero where the triangle has no area.
  [[nodiscard]] const glm::vec3& normal(std::uint32_t triangle) const { return normals_[triangle]; }

 private:
  struct Node {
    Box box;
    std::uint32_t first = 0, count = 0;  // of order_; no count: the children are `first` and the next
  };
  void build(std::uint32_t node, std::uint32_t first, std::uint32_t count, std::vector<glm::vec3>& centres);

  const SurfaceMesh& mesh_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<glm::vec3> normals_;
};

}  // namespace gs::qnv::displaced
