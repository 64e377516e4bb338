#pragma once

#include "qnv/displaced/manifold.h"
#include "qnv/displaced/simplify/cost_queue.h"
#include "qnv/displaced/simplify/quadric.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// A triangle may not turn further than this (a cosine) by one collapse, nor become narrower (1: equilateral).
struct Care {
  double least_turn, least_quality;
};
/// Where no edge may go any more, more is allowed.
inline constexpr std::array<Care, 2> kCare{{{0.2, 0.08}, {0.05, 0.03}}};
inline constexpr Care kCareless{-2, 0};
inline constexpr std::size_t kFromTheStart = 16;

/// An edge that is no more: `gone` went to where `stays` is. `left` and `right` were beside both, left the third corner
/// of the triangle in which `gone` came before `stays`; kNone: the mesh ended there.
struct HalfCollapse {
  std::uint32_t gone, stays, left, right;
  double distance;  // of the planes round both from where they are now, root of the mean square, units of the box
};

/// One mesh on its way to fewer triangles (simplify.h). One thread.
class Simplifier {
 public:
  /// What collapses may do: `any` place a vertex anew, `halves` leave one of both where it is, for the sake of planes
  /// and their edges, however narrow triangles become.
  enum class Way { any, halves };
  /// `kept`: vertices that stay where they are; none: none does.
  explicit Simplifier(const SurfaceMesh& mesh, std::vector<bool> kept = {}, Way way = Way::any);
  /// `begun`: what there is was thinned until so many times as many triangles were left.
  void run(std::size_t wanted, std::size_t begun = kFromTheStart);
  /// On the way to a mesh of `wanted` triangles, until so many are `left`.
  void thin(std::size_t wanted, std::size_t left);
  /// At most so many collapses of `halves` that do not depend on each other, the cheapest first: no two vertices that
  /// go are neighbours, none goes to one that another one goes to.
  [[nodiscard]] std::vector<HalfCollapse> collapse_apart(std::size_t most);
  /// From now on triangles may turn any way.
  void turn_freely() { care_ = kCareless; }
  [[nodiscard]] std::size_t triangles() const { return count_; }
  /// `places`: of the vertices that there were, or kNone.
  [[nodiscard]] SurfaceMesh result(const SurfaceMesh& mesh, std::vector<std::uint32_t>& places) const;

 private:
  [[nodiscard]] std::uint32_t& vertex_at(std::uint32_t corner) { return triangles_[corner / 3][corner % 3]; }
  [[nodiscard]] bool alive(std::uint32_t triangle) const { return triangles_[triangle][0] != kNone; }
  void gather(std::uint32_t v, std::vector<std::uint32_t>& corners);
  [[nodiscard]] glm::dvec3 place_for(std::uint32_t u, std::uint32_t v, const Quadric& q) const;
  void push(std::uint32_t u, std::uint32_t v);
  void push_round(std::uint32_t v);
  [[nodiscard]] bool may_turn(std::span<const std::uint32_t> corners, std::uint32_t other,
                              const glm::dvec3& place) const;
  [[nodiscard]] bool linked_well(std::uint32_t u, std::uint32_t v);
  [[nodiscard]] double cost(std::uint32_t u, std::uint32_t v, const Quadric& q) const;
  [[nodiscard]] bool stale(const Candidate& candidate) const;
  [[nodiscard]] bool may_merge(std::uint32_t u, std::uint32_t v, const glm::dvec3& place);
  void merge(std::uint32_t u, std::uint32_t v, const Quadric& q, const glm::dvec3& place);
  bool collapse(std::uint32_t u, std::uint32_t v);
  void push_all();
  std::uint32_t add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  void append_corner(std::uint32_t v, std::uint32_t corner);
  [[nodiscard]] double round(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  [[nodiscard]] std::uint32_t triangle_left_of(std::uint32_t a, std::uint32_t b);
  [[nodiscard]] std::uint32_t third(std::uint32_t triangle, std::uint32_t a, std::uint32_t b) const;
  void repair(double edge);
  void close_rims(double most);
  void cut_tunnels(double most);
  bool cut_along(const Corners& cycle);
  [[nodiscard]] bool joined_elsewhere(const Corners& cycle);
  void collapse_to(std::size_t wanted);
  double see_area(std::size_t wanted);

  std::vector<glm::dvec3> positions_;
  std::vector<Corners> triangles_;
  std::vector<Quadric> quadrics_;
  std::vector<double> areas_;                      // round a vertex
  std::vector<std::uint32_t> head_, tail_, next_;  // the corners of a vertex, as a list
  std::vector<std::uint32_t> stamp_, mark_, seen_triangles_;
  std::uint32_t searches_ = 0;
  std::vector<bool> rim_, kept_;
  Way way_;
  Care care_ = kCare[0];
  double noise_ = 0;  // twice the area of triangles that are far smaller than those wanted
  std::uint32_t marks_ = 0;
  std::size_t count_ = 0;
  CostQueue queue_;
  std::vector<std::uint32_t> at_u_, at_v_, round_, seen_u_, seen_v_;
};

/// On the way to a mesh of `wanted` triangles: one of some times as many, made in `parts` (a power of two, at most 64)
/// side by side. What is shared by two of them stays as it is. It is the same on any number of threads.
[[nodiscard]] SurfaceMesh thinned(const SurfaceMesh& mesh, std::size_t wanted, std::size_t parts, unsigned threads);

}  // namespace gs::qnv::displaced
