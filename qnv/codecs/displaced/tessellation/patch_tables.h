#pragma once

#include "qnv/codecs/displaced/patches.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Returns the number of vertices of a patch at a level, including vertices on edges.
[[nodiscard]] constexpr std::size_t patch_vertices(int level) {
  const std::size_t n = std::size_t{1} << level;
  return (n + 1) * (n + 2) / 2;
}
/// Returns the number of vertices that a level has in addition to the previous level.
[[nodiscard]] constexpr std::size_t new_patch_vertices(int level) {
  return level == 0 ? 3 : patch_vertices(level) - patch_vertices(level - 1);
}

/// Numbering of the vertices of every patch: the corners (level 0), then the new vertices of each level, row by row.
/// Thus the vertices of a coarser level are a prefix of the vertices of a finer level.
struct PatchTable {
  using Number = std::uint16_t;
  /// Part of a patch edge that is a side of a triangle: from position `from` to position `from + 1` on the edge.
  struct Side {
    static constexpr std::uint8_t kNone = 3;
    std::uint8_t edge = kNone;
    std::uint16_t from = 0;
  };
  /// New vertex: the midpoint of its two parents.
  struct Middle {
    Number number;
    std::array<Number, 2> parents;
  };

  std::vector<displaced::GridPlace> places;  // grid positions of the new vertices, in steps of this level
  std::vector<Middle> inside;  // new vertices that are not on an edge
  std::array<std::vector<Middle>, 3> on_edges;  // new vertices on edge k, from corner k to corner k + 1
  std::array<std::vector<Number>, 3> edges;     // all vertices of edge k, from corner k to corner k + 1
  std::vector<Number> grid;                     // all vertices, row by row (displaced::row_start)
  std::vector<std::array<Number, 3>> inner;     // triangles without a side on an edge
  std::vector<std::array<Number, 3>> border;    // all other triangles
  std::vector<Number> turns;  // index in PatchLoops::products, for `inner`, then `border`
  std::vector<std::array<Side, 3>> sides;  // of each triangle in `border`; side k starts at corner k
};

/// Returns the table of a level from 0 to displaced::kDeepestPatch. Safe from any thread.
[[nodiscard]] const PatchTable& patch_table(int level);

}  // namespace gs::qnv
