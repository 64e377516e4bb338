#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Returns Newell's vector of a polygon, computed relative to its first corner. Its direction is the normal by the
/// right-hand rule, its length twice the area. Exact except for rounding of doubles.
[[nodiscard]] glm::dvec3 newell_vector(std::span<const glm::vec3> polygon);

/// Triangulator of polygons by ear clipping. Polygons may be concave and have holes joined by bridge edges (VRML97
/// 6.23, `convex FALSE`). Reuses its memory for the next polygon.
///
/// Accepts any finite coordinates. A simple planar polygon with n corners gives n - 2 triangles that cover it exactly,
/// or fewer if corners coincide. Any other polygon gives some triangles between its corners. Takes time of about n log
/// n for practical polygons, and at most 512 n short steps. After some failed attempts on a polygon that crosses
/// itself, the rest becomes a fan.
class PolygonTriangulator {
 public:
  /// Returns three indices of `polygon` per triangle, in the winding of the polygon. Valid until the next call.
  [[nodiscard]] std::span<const std::uint32_t> triangulate(std::span<const glm::vec3> polygon);

 private:
  enum class Strictness : std::uint8_t { clear, interior_clear, any_convex };

  void quadrilateral(std::span<const glm::vec3> polygon, const glm::dvec3& normal);
  void project(std::span<const glm::vec3> polygon, const glm::dvec3& normal);
  void link();
  void clip();
  void fan();
  void settle();
  [[nodiscard]] bool in_ring(std::uint32_t corner) const { return next_[previous_[corner]] == corner; }
  [[nodiscard]] bool is_spike(std::uint32_t corner) const;
  void unlink(std::uint32_t corner);
  void refresh(std::uint32_t corner);
  void build_grid();
  void enter_grid(std::uint32_t corner);
  void enqueue(std::uint32_t corner);
  void enqueue_all();
  void spend(std::size_t steps) { steps_left_ -= steps < steps_left_ ? steps : steps_left_; }
  [[nodiscard]] bool is_ear(std::uint32_t tip, Strictness strictness);
  [[nodiscard]] bool grid_blocks(std::uint32_t tip, Strictness strictness);
  [[nodiscard]] bool blocks(std::uint32_t corner, std::uint32_t tip, Strictness strictness) const;
  [[nodiscard]] double area(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] glm::dvec2 to_grid(std::uint32_t corner) const;

  static constexpr std::uint32_t kNone = 0xffffffff;

  std::vector<std::uint32_t> triangles_;
  std::vector<glm::dvec2> points_;
  std::vector<std::uint32_t> previous_, next_;
  // Corners that are not strictly convex; only they can be inside an ear. Stored as a list, the index of each corner in
  // that list, and a grid if there are many. Grid cells may still contain corners that have left the list.
  std::vector<std::uint32_t> reflex_, place_;
  std::vector<std::uint32_t> cell_head_, cell_next_;
  std::vector<bool> in_grid_;
  // Entry of the queue of corners to try. Only the latest entry of a corner is valid.
  struct Candidate {
    std::uint32_t corner, turn;
  };
  std::vector<Candidate> queue_;
  std::vector<std::uint32_t> turn_;
  std::size_t queue_head_ = 0;
  std::vector<std::uint32_t> changed_;  // corners with new neighbours
  std::uint32_t first_ = 0;             // any corner of the ring
  glm::dvec2 grid_origin_{0}, grid_scale_{0};
  std::size_t columns_ = 0, rows_ = 0;  // 0 if there is no grid
  std::size_t grid_filling_ = 0;
  std::size_t remaining_ = 0;
  std::size_t steps_left_ = 0;
};

}  // namespace gs::vrml
