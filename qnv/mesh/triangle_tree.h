#pragma once

#include "qnv/base/description.h"
#include "qnv/mesh/centre.h"
#include "qnv/mesh/manifold.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Point on a surface: a triangle and a position in it.
struct SurfacePoint {
  std::uint32_t triangle = kNone;  // kNone if there is no point
  glm::vec3 position{0};
  float distance = std::numeric_limits<float>::infinity();  // from the query point; signed if along a line
};

/// Bounding volume hierarchy of the triangles of a mesh. Immutable. Any thread.
class TriangleTree {
 public:
  /// `mesh` must outlive this object. Builds the tree on `threads` threads (0 means one per core).
  explicit TriangleTree(const SurfaceMesh& mesh, unsigned threads = 0);

  /// Intersects the surface with the line through `from` along +-`direction` (a unit vector). Returns the intersection
  /// that is nearest to `from`, within `reach`. Ignores triangles with a cosine between normal and `facing` below
  /// `least`.
  [[nodiscard]] SurfacePoint along(const glm::vec3& from, const glm::vec3& direction, float reach,
                                   const glm::vec3& facing, float least) const;
  /// Returns the intersection of the line through `from` along +-`direction` with one triangle, within `reach`.
  [[nodiscard]] SurfacePoint on(std::uint32_t triangle, const glm::vec3& from, const glm::vec3& direction,
                                float reach) const;
  /// Returns the nearest point of the surface within `reach`. Ignores triangles with a cosine between normal and
  /// `facing` below `least`.
  [[nodiscard]] SurfacePoint nearest(const glm::vec3& from, float reach, const glm::vec3& facing, float least) const;
  /// Returns the barycentric coordinates of a point in its triangle.
  [[nodiscard]] glm::vec3 weights(const SurfacePoint& point) const;
  /// Returns the point on the smooth surface that the shading suggests: on a curve perpendicular to the normals of the
  /// corners. Returns the point itself if the mesh has no normals.
  [[nodiscard]] glm::vec3 smooth(const SurfacePoint& point) const;

 private:
  using Four = float __attribute__((vector_size(16)));
  /// Inner node with up to four children. A count of 0 marks an inner node as child; otherwise the child is a leaf. An
  /// unused child has an empty box.
  struct Node {
    std::array<Four, 3> lower, upper;
    std::array<std::uint32_t, 4> first, count;  // index of the child node or leaf
  };
  /// Leaf with up to four triangles.
  struct Leaf {
    std::array<Four, 3> a, ab, ac, normal;  // a corner, the edges from it, and the unit normal (zero if the triangle
                                            // has no area)
    std::array<std::uint32_t, 4> triangle;
  };
  /// Part of the tree to build: the triangles of a node, and the indices of the node, its descendants and its leaves.
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
  std::map<std::uint32_t, Size> sizes_;  // sizes of trees, by number of triangles
};

}  // namespace gs::qnv::displaced
