#pragma once

#include "qnv/codecs/displaced/patches.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Returns the number of vertices of a patch at a level, edges included.
[[nodiscard]] constexpr std::size_t patch_vertices(int level) {
  const std::size_t n = std::size_t{1} << level;
  return (n + 1) * (n + 2) / 2;
}
/// Returns how many of these the previous level lacks.
[[nodiscard]] constexpr std::size_t new_patch_vertices(int level) {
  return level == 0 ? 3 : patch_vertices(level) - patch_vertices(level - 1);
}

/// Numbering of the vertices of every patch: the corners (level 0), then the new vertices of level 1, of level 2, and
/// so on, each level row by row. Thus the vertices of a coarser level are a prefix of a finer one.
struct PatchTable {
  using Number = std::uint16_t;
  /// Side of a triangle that lies on an edge of the patch: from position `from` to `from + 1` of that edge.
  struct Side {
    static constexpr std::uint8_t kNone = 3;
    std::uint8_t edge = kNone;
    std::uint16_t from = 0;
  };
  /// New vertex, and the two vertices that it lies between.
  struct Middle {
    Number number;
    std::array<Number, 2> parents;
  };

  std::vector<displaced::GridPlace> places;     // of the new vertices, in steps of this level
  std::vector<Middle> inside;                   // new vertices not on an edge
  std::array<std::vector<Middle>, 3> on_edges;  // new vertices on edge k, from corner k to corner k + 1
  std::array<std::vector<Number>, 3> edges;     // all vertices of edge k, from corner k to corner k + 1
  std::vector<Number> grid;                     // all vertices, row by row (displaced::row_start)
  std::vector<std::array<Number, 3>> inner;     // triangles without a side on an edge
  std::vector<std::array<Number, 3>> border;    // all other triangles
  std::vector<Number> turns;                    // index in PatchLoops::products for each of `inner`, then of `border`
  std::vector<std::array<Side, 3>> sides;       // of each of `border`: side k from corner k to corner k + 1
};

/// Returns the table of a level from 0 to displaced::kDeepestPatch. Safe from any thread.
[[nodiscard]] const PatchTable& patch_table(int level);

}  // namespace gs::qnv
