#pragma once

#include "qnv/mesh/manifold.h"
#include "qnv/mesh/simplify/cost_queue.h"
#include "qnv/mesh/simplify/linked_triangles.h"
#include "qnv/mesh/simplify/quadric.h"
#include "qnv/mesh/simplify/simplify.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Limits of a collapse: the maximum turn of a triangle, as a cosine, and the minimum quality of a triangle (1 means
/// equilateral).
struct Care {
  double least_turn, least_quality;
};
/// Levels of limits. The next level applies when the current one allows no more collapses.
inline constexpr std::array<Care, 2> kCare{{{0.2, 0.08}, {0.05, 0.03}}};
inline constexpr Care kCareless{-2, 0};
inline constexpr std::size_t kFromTheStart = 16;

/// Collapse that moved the vertex `gone` to the vertex `stays`. `left` and `right` were adjacent to both vertices;
/// kNone on a rim. `left` is the third corner of the triangle in which `gone` preceded `stays`.
struct HalfCollapse {
  std::uint32_t gone, stays, left, right;
  double distance;  // root mean square distance from the planes around both, units of the box
};

/// Mesh during simplification (simplify.h). One thread at a time.
class Simplifier {
 public:
  /// Kind of collapse. `any` may move the vertex to a new position. `halves` keeps one of both vertices at its
  /// position, which preserves planes and their edges but may make narrow triangles.
  enum class Way { any, halves };
  /// `kept` marks vertices that must not move; if empty, all may move.
  explicit Simplifier(const SurfaceMesh& mesh, std::vector<bool> kept = {}, Way way = Way::any);
  /// Simplifies to `wanted` triangles. If thin() was called before, `begun` is its `left` divided by `wanted`.
  void run(std::size_t wanted, std::size_t begun = kFromTheStart);
  /// Simplifies until `left` triangles remain, as the first part of the way to `wanted` triangles.
  void thin(std::size_t wanted, std::size_t left);
  /// Makes at most `most` independent half-edge collapses, cheapest first. No two removed vertices are adjacent. A
  /// vertex that another vertex moves to does not move, and no third vertex moves to it.
  [[nodiscard]] std::vector<HalfCollapse> collapse_apart(std::size_t most);
  /// Removes the limit on how triangles may turn.
  void turn_freely() { care_ = kCareless; }
  [[nodiscard]] std::size_t triangles() const { return mesh_.count(); }
  /// Returns the simplified mesh. Fills `places` with the new index of each original vertex; kNone if it was removed.
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
  std::vector<double> areas_;  // area around each vertex
  std::vector<std::uint32_t> stamp_, mark_, seen_triangles_;
  std::uint32_t searches_ = 0;
  std::vector<bool> rim_, kept_;
  Way way_;
  Care care_ = kCare[0];
  double noise_ = 0;  // twice the area below which a triangle is noise: far smaller than the triangles of the result
  std::uint32_t marks_ = 0;
  CostQueue queue_;
  std::vector<std::uint32_t> at_u_, at_v_, round_, seen_u_, seen_v_;
};

/// Returns a mesh with several times `wanted` triangles. Simplifies `parts` parts in parallel; `parts` is a power of
/// two and at most 64. Geometry on the border of two parts stays unchanged. The result does not depend on the number of
/// threads or ranks. Each rank simplifies some parts; only rank 0 returns the mesh, other ranks an empty one.
[[nodiscard]] SurfaceMesh thinned(const SurfaceMesh& mesh, std::size_t wanted, std::size_t parts, unsigned threads,
                                  const SimplifyRanks& ranks = {});

}  // namespace gs::qnv::displaced
