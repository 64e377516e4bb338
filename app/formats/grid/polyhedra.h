#pragma once

#include "app/formats/grid/grid_cells.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::app {

/// Which faces the polyhedra of a piece of a VTK XML file have; kBadIndex in the place of what is negative or too
/// large.
struct PolyhedronArrays {
  bool numbered = false;
  std::vector<std::int32_t> ends;  // of each cell in `faces`; of other cells whatever stands there
  /// Of a cell how many faces, then of each how many corners, and these; where they are numbered, numbers of faces.
  std::vector<std::int32_t> faces;
  std::vector<std::int32_t> face_ends, corners;  // of numbered faces: where each ends in `corners`
};

/// The greatest that is no kBadIndex; 0: there is none.
[[nodiscard]] std::size_t greatest_index(std::span<const std::int32_t> indices);
/// How many faces there must be for `numbers` to be theirs.
[[nodiscard]] std::size_t faces_below(std::span<const std::int32_t> numbers);

/// Gives the polyhedra of `grid` from `first_cell` on their faces, as GridCells has them; a cell whose faces are not
/// there is left with nothing. Corners count from `first_point`, of which on there are `points`. Throws OutOfBudget.
void place_polyhedra(const PolyhedronArrays& arrays, std::size_t first_cell, std::size_t first_point,
                     std::size_t points, GridCells& grid, vrml::SceneGraph& scene);

}  // namespace gs::app
