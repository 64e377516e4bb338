#pragma once

#include "qnv/displaced/patches.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Vertices of a patch of a level, those on its edges too.
[[nodiscard]] constexpr std::size_t patch_vertices(int level) {
  const std::size_t n = std::size_t{1} << level;
  return (n + 1) * (n + 2) / 2;
}
/// Those that the level before does not have.
[[nodiscard]] constexpr std::size_t new_patch_vertices(int level) {
  return level == 0 ? 3 : patch_vertices(level) - patch_vertices(level - 1);
}

/// How the vertices of every patch are numbered: those of level 0, its corners, then the new ones of level 1, then of
/// level 2, and so on, each level row by row. The vertices of a coarser level are the first ones of a finer one.
struct PatchTable {
  using Number = std::uint16_t;
  /// A side of a triangle that lies on an edge of the patch: from the place `from` to `from + 1` of that edge.
  struct Side {
    static constexpr std::uint8_t kNone = 3;
    std::uint8_t edge = kNone;
    std::uint16_t from = 0;
  };
  /// A new vertex, and those between which it lies.
  struct Middle {
    Number number;
    std::array<Number, 2> parents;
  };

  std::vector<displaced::GridPlace> places;     // of the new vertices, in steps of this level
  std::vector<Middle> inside;                   // the new vertices that lie on no edge
  std::array<std::vector<Middle>, 3> on_edges;  // those that lie on edge k, from corner k to corner k + 1
  std::array<std::vector<Number>, 3> edges;     // the vertices of edge k, from corner k to corner k + 1
  std::vector<Number> grid;                     // the numbers of all vertices, row by row (displaced::row_start)
  std::vector<std::array<Number, 3>> inner;     // triangles without a side on an edge
  std::vector<std::array<Number, 3>> border;    // the others
  std::vector<Number> turns;  // where those in `inner`, then those in `border`, are in PatchLoops::products
  std::vector<std::array<Side, 3>> sides;  // of those in `border`: side k from corner k to corner k + 1
};

/// Of a level from 0 to displaced::kDeepestPatch. Any thread.
[[nodiscard]] const PatchTable& patch_table(int level);

}  // namespace gs::qnv
