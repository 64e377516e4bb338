#pragma once

#include "qnv/codecs/displaced/patches.h"

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Predicted position of a new vertex, and the directions in which it may be displaced.
struct Prediction {
  glm::vec3 position{0};
  glm::vec3 normal{0};  // unit vector
  glm::vec3 sideways{0};  // on a rim or crease: unit vector across it, tangent to the surface; otherwise 0
};

/// Vertices along an edge of the base mesh, starting at the edge's `from`. Returns their indices in another numbering
/// of the same patches.
class EdgeWalk {
 public:
  /// `patch` is adjacent to the edge; it selects the side of a crease.
  EdgeWalk(const Patches& patches, std::uint32_t edge, std::uint32_t patch, const Patches& numbering, int level)
      : n_(std::uint32_t{1} << level) {
    std::uint32_t k = 0;
    while (k < 2 && patches.edge(patch, k) != edge) ++k;
    const std::uint32_t in = numbering.edge(patch, k);
    const bool forward = patches.triangles()[patch][k] == patches.edges()[edge].from;
    const Corners& corners = numbering.triangles()[patch];
    from_ = corners[forward ? k : (k + 1) % 3];
    to_ = corners[forward ? (k + 1) % 3 : k];
    same_way_ = numbering.edges()[in].from == from_;
    start_ = static_cast<std::uint32_t>(numbering.edge_start(in, level));
  }
  std::uint32_t operator()(std::uint32_t t) const {
    return t == 0 ? from_ : t == n_ ? to_ : start_ + (same_way_ ? t : n_ - t) - 1;
  }

 private:
  std::uint32_t n_, from_ = 0, to_ = 0, start_ = 0;
  bool same_way_ = true;
};

/// New vertex of a level, between two vertices of the previous level.
struct NewVertex {
  std::uint32_t vertex = 0, a = 0, b = 0;  // vertex indices of Patches
  std::uint32_t edge = kNone;  // edge of the base mesh that contains the vertex, or kNone
  std::uint32_t slot_a = 0, slot_b = 0;  // indices of a and b in `slots`, the patches cut along creases
  std::uint32_t other_a = 0, other_b = 0;  // indices in `slots` on the other side of a crease
};

/// Calls visit(NewVertex) for every new vertex of a level (1 and up). For every other vertex, calls keep(vertex,
/// before) with its index at the previous level as `before`. `slots` is patches.cut(). Processes only part `part` of
/// `parts` disjoint parts of the level.
template <class Visit, class Keep>
void visit_level(const Patches& patches, const Patches& slots, int level, Visit visit, Keep keep, std::size_t part = 0,
                 std::size_t parts = 1) {
  const auto n = std::uint32_t{1} << level, half = n / 2;
  const auto begin = [&](std::size_t of, std::size_t i) { return static_cast<std::uint32_t>(of * i / parts); };
  const std::size_t base = patches.base_vertices(), edges = patches.edges().size(), all = patches.size();
  for (std::uint32_t v = begin(base, part); v < begin(base, part + 1); ++v) keep(v, v);
  for (std::uint32_t e = begin(edges, part); e < begin(edges, part + 1); ++e) {
    const Patches::Edge& edge = patches.edges()[e];
    const auto start = static_cast<std::uint32_t>(patches.edge_start(e, level));
    const EdgeWalk walk(patches, e, edge.owner, patches, level - 1), slot(patches, e, edge.owner, slots, level - 1);
    const EdgeWalk other(patches, e, edge.crease ? edge.other : edge.owner, slots, level - 1);
    for (std::uint32_t t = 1; t < n; ++t) {
      if (t % 2 == 0)
        keep(start + t - 1, walk(t / 2));
      else
        visit(NewVertex{start + t - 1, walk(t / 2), walk(t / 2 + 1), e, slot(t / 2), slot(t / 2 + 1), other(t / 2),
                        other(t / 2 + 1)});
    }
  }
  std::vector<std::uint32_t> grid, slot_grid;
  for (std::uint32_t p = begin(all, part); p < begin(all, part + 1) && level > 1; ++p) {
    patches.grid(p, level - 1, grid);
    slots.grid(p, level - 1, slot_grid);
    auto v = static_cast<std::uint32_t>(patches.inner_start(p, level));
    for (std::uint32_t j = 1; j + 1 < n; ++j)
      for (std::uint32_t i = 1; i + j < n; ++i, ++v) {
        const auto at = [&](std::uint32_t x, std::uint32_t y) { return row_start(y, half) + x; };
        const std::uint32_t x = i / 2, y = j / 2;
        if (i % 2 == 0 && j % 2 == 0) {
          keep(v, grid[at(x, y)]);
          continue;
        }
        const std::size_t a = i % 2 == 0 || j % 2 == 0 ? at(x, y) : at(x + 1, y);
        const std::size_t b = j % 2 == 0 ? at(x + 1, y) : at(x, y + 1);
        visit(NewVertex{v, grid[a], grid[b], kNone, slot_grid[a], slot_grid[b], slot_grid[a], slot_grid[b]});
      }
  }
}

/// Returns the unit mean normals at the slots of a level; zero if undefined. Slots are the vertices of the patches cut
/// along creases. `positions` are the positions of the vertices. The result does not depend on the number of threads (0
/// means one per core).
[[nodiscard]] std::vector<glm::vec3> slot_normals(const Patches& patches, const Patches& slots, int level,
                                                  std::span<const glm::vec3> positions, unsigned threads = 1);

/// Predicts a vertex between vertices a and b: on a curve perpendicular to their normals (T. Boubekeur, M. Alexa, Phong
/// tessellation, 2008). On a rim or crease, predicts their midpoint.
[[nodiscard]] inline Prediction predict(const NewVertex& v, bool line, std::span<const glm::vec3> positions,
                                        std::span<const glm::vec3> normals) {
  constexpr float kCurve = 0.5f;  // fraction of the way to the mean of both tangent planes
  constexpr float kMax = 0.15f;  // maximum distance from the midpoint, relative to the edge's length
  Prediction p;
  const glm::vec3 a = positions[v.a], b = positions[v.b], middle = 0.5f * (a + b), along = b - a;
  const glm::vec3 normal_a = normals[v.slot_a], normal_b = normals[v.slot_b];
  p.normal = normal_a + normal_b;
  if (v.other_a != v.slot_a || v.other_b != v.slot_b) p.normal += normals[v.other_a] + normals[v.other_b];
  const float sum = glm::length(p.normal);
  p.normal = sum > 1e-6f ? p.normal / sum : normal_a;
  p.position = middle;
  if (line) {
    p.sideways = glm::cross(along, p.normal);
    const float across = glm::length(p.sideways);
    p.sideways = across > 0 ? p.sideways / across : glm::vec3(0);
    return p;
  }
  const float length = glm::length(along);
  glm::vec3 bend =
      0.5f * kCurve * (normal_a * glm::dot(normal_a, a - middle) + normal_b * glm::dot(normal_b, b - middle));
  const float size = glm::length(bend);
  if (size > kMax * length) bend *= kMax * length / size;
  p.position += bend;
  return p;
}

}  // namespace gs::qnv::displaced
