#pragma once

#include "qnv/mesh/manifold.h"
#include "qnv/mesh/simplify/cost_queue.h"
#include "qnv/mesh/simplify/linked_triangles.h"
#include "qnv/mesh/simplify/quadric.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Limits of a collapse: the largest turn of a triangle (as a cosine), and its least quality (1: equilateral).
struct Care {
  double least_turn, least_quality;
};
/// Levels of limits; the next level applies when no more edges may collapse.
inline constexpr std::array<Care, 2> kCare{{{0.2, 0.08}, {0.05, 0.03}}};
inline constexpr Care kCareless{-2, 0};
inline constexpr std::size_t kFromTheStart = 16;

/// Half-edge collapse: vertex `gone` moved to `stays`. `left` and `right` were adjacent to both; `left` is the third
/// corner of the triangle in which `gone` preceded `stays`; kNone on a rim.
struct HalfCollapse {
  std::uint32_t gone, stays, left, right;
  double distance;  // root mean square distance between the planes around both and their position, units of the box
};

/// Mesh during simplification (simplify.h). Not thread-safe.
class Simplifier {
 public:
  /// Kind of collapse: `any` may compute a new position; `halves` keeps one of both vertices in place, which preserves
  /// planes and their edges but may make narrow triangles.
  enum class Way { any, halves };
  /// `kept` marks vertices that must not move; empty means none.
  explicit Simplifier(const SurfaceMesh& mesh, std::vector<bool> kept = {}, Way way = Way::any);
  /// Simplifies to `wanted` triangles. `begun`: an earlier thin() left `begun` times as many triangles.
  void run(std::size_t wanted, std::size_t begun = kFromTheStart);
  /// Simplifies until `left` triangles remain, as a step towards a mesh of `wanted` triangles.
  void thin(std::size_t wanted, std::size_t left);
  /// Makes at most `most` independent half-edge collapses, cheapest first: no two removed vertices are adjacent, and
  /// none moves to one that another moves to.
  [[nodiscard]] std::vector<HalfCollapse> collapse_apart(std::size_t most);
  /// Removes the limit on how triangles may turn.
  void turn_freely() { care_ = kCareless; }
  [[nodiscard]] std::size_t triangles() const { return mesh_.count(); }
  /// Fills `places` with the new number of each original vertex, or kNone.
  [[nodiscard]] SurfaceMesh result(const SurfaceMesh& mesh, std::vector<std::uint32_t>& places) const;

 private:
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
  [[nodiscard]] double round(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
  void repair(double edge);
  void close_rims(double most);
  void cut_tunnels(double most);
  bool cut_along(const Corners& cycle);
  [[nodiscard]] bool joined_elsewhere(const Corners& cycle);
  void collapse_to(std::size_t wanted);
  double see_area(std::size_t wanted);

  std::vector<glm::dvec3> positions_;
  LinkedTriangles mesh_;
  std::vector<Quadric> quadrics_;
  std::vector<double> areas_;  // around a vertex
  std::vector<std::uint32_t> stamp_, mark_, seen_triangles_;
  std::uint32_t searches_ = 0;
  std::vector<bool> rim_, kept_;
  Way way_;
  Care care_ = kCare[0];
  double noise_ = 0;  // twice the area below which triangles are far smaller than the wanted ones
  std::uint32_t marks_ = 0;
  CostQueue queue_;
  std::vector<std::uint32_t> at_u_, at_v_, round_, seen_u_, seen_v_;
};

/// Returns a mesh of several times `wanted` triangles, simplified in `parts` (a power of two, at most 64) in parallel.
/// Geometry shared by two parts stays unchanged. The result does not depend on the number of threads.
[[nodiscard]] SurfaceMesh thinned(const SurfaceMesh& mesh, std::size_t wanted, std::size_t parts, unsigned threads);

}  // namespace gs::qnv::displaced
