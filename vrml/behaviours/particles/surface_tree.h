#pragma once

#include "base/box.h"
#include "vrml/behaviours/particles/particle_random.h"
#include "vrml/mesh/mesh.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace gs::vrml {

/// Triangles of a geometry in a tree of boxes, for particles that start on a surface or rebound from it.
class SurfaceTree {
 public:
  /// Maximum triangles; further ones are left out.
  static constexpr std::size_t kMaxTriangles = std::size_t{1} << 18;

  explicit SurfaceTree(const Mesh& mesh);

  struct Hit {
    float part = 1;  // position on the line, 0 to 1
    glm::vec3 point{0}, normal{0};
    glm::vec3 face{0};  // unit normal of the triangle
  };
  /// Returns the first crossing of a line with the surface; both sides count.
  [[nodiscard]] std::optional<Hit> first_hit(const glm::vec3& from, const glm::vec3& to) const;
  /// Appends the positions of all crossings of a line, unsorted.
  void append_crossings(const glm::vec3& from, const glm::vec3& to, std::vector<float>& parts) const;

  struct Point {
    glm::vec3 point{0}, normal{0, 1, 0};
  };
  /// Returns a point of the surface; all points are equally likely.
  [[nodiscard]] Point random_point(ParticleRandom& random) const;
  /// Returns a point inside of a closed surface; all points are equally likely. Returns a point on the surface if few
  /// points are inside.
  [[nodiscard]] glm::vec3 random_inner_point(ParticleRandom& random) const;

  [[nodiscard]] bool empty() const { return triangles_.empty(); }
  [[nodiscard]] bool solid() const { return solid_; }
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  [[nodiscard]] std::size_t bytes() const {
    return triangles_.size() * (sizeof(Triangle) + sizeof(double)) + nodes_.size() * sizeof(Branch);
  }

 private:
  struct Triangle {
    std::array<glm::vec3, 3> corners, normals;
  };
  struct Branch {
    Box box;
    std::uint32_t first = 0, count = 0;  // leaf: its triangles; otherwise `first` is the second child, and count is 0
  };
  struct Crossing {
    float part = 0, u = 0, v = 0;
  };
  static std::optional<Crossing> crossing(const Triangle& triangle, const glm::vec3& from, const glm::vec3& direction);
  void build(std::uint32_t first, std::uint32_t last);
  template <class Visit>
  void visit_near(const glm::vec3& from, const glm::vec3& direction, const float& end, const Visit& visit) const;

  std::vector<Triangle> triangles_;
  std::vector<double> areas_;  // sums of the areas of the triangles so far
  std::vector<Branch> nodes_;
  Box bounds_;
  bool solid_ = true;
};

}  // namespace gs::vrml
