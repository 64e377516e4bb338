#pragma once

#include "qnv/mesh/manifold.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

/// Side of a triangle.
struct Side {
  std::uint32_t low, high;  // vertices at its ends, the lower index first
  std::uint32_t at;  // 3 * triangle + corner at the start of the side
};

inline bool same_edge(const Side& a, const Side& b) { return a.low == b.low && a.high == b.high; }

bool side_before(const Side& a, const Side& b);

/// Returns all sides, sorted by their vertices, then by triangle index.
[[nodiscard]] std::vector<Side> sorted_sides(std::span<const Corners> triangles);

/// Calls each(first, last) for every edge, with the range of its sides. Calls it from several threads at once, in
/// undefined order.
void for_each_edge(std::span<const Side> sides, const std::function<void(std::size_t, std::size_t)>& each);

/// Sets the neighbours at edges with exactly two triangles that have the same orientation. `beside` must have its final
/// size. Returns the sides of all other edges with several triangles, in the order of sorted_sides().
[[nodiscard]] std::vector<Side> join_at(std::span<const Corners> triangles, std::span<const Side> sides,
                                        Neighbours& beside);

/// Calls each(corner) for all corners at the vertex of the given corner, starting with that corner; continues across
/// neighbours. A corner is 3 * triangle + corner. Stops when `each` returns false.
template <class Each>
void for_each_in_fan(std::span<const Corners> triangles, const Neighbours& beside, std::uint32_t corner,
                     const Each& each) {
  const std::uint32_t v = triangles[corner / 3][corner % 3];
  if (!each(corner)) return;
  // Continues across the side that starts at the corner. If that direction reaches a rim, continues across the side
  // that ends at the corner.
  for (const std::uint32_t side : {0u, 2u})
    for (std::uint32_t t = corner / 3, k = corner % 3;;) {
      const std::uint32_t next = beside[t][(k + side) % 3];
      if (next == corner / 3) return;
      if (next == kNone) break;
      const Corners& c = triangles[next];
      t = next;
      k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
      if (!each(3 * t + k)) return;
    }
}

/// Reports for each vertex whether its triangles form one fan.
[[nodiscard]] std::vector<std::uint8_t> one_fan(std::span<const Corners> triangles, std::size_t vertices,
                                                const Neighbours& beside);

}  // namespace gs::qnv::displaced
