#pragma once

#include "app/formats/vtk/grid_cells.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::app {

/// Face arrays of the polyhedra in a piece of a VTK XML file. Negative or too large values are kBadIndex.
struct PolyhedronArrays {
  bool numbered = false;
  std::vector<std::int32_t> ends;  // end of each cell in `faces`; arbitrary for other cells
  /// For each cell the number of faces, then for each face the number of corners and the corners; or face numbers, if
  /// `numbered`.
  std::vector<std::int32_t> faces;
  std::vector<std::int32_t> face_ends, corners;  // numbered faces: end of each face in `corners`
};

/// Returns the largest index other than kBadIndex; 0 if there is none.
[[nodiscard]] std::size_t greatest_index(std::span<const std::int32_t> indices);
/// Returns the number of faces that `numbers` require.
[[nodiscard]] std::size_t faces_below(std::span<const std::int32_t> numbers);

/// Adds faces to the polyhedra of `grid` from `first_cell` on, in the layout of GridCells. A cell with missing faces
/// becomes empty. Corners count from `first_point`; there are `points` points. Throws OutOfBudget.
void place_polyhedra(const PolyhedronArrays& arrays, std::size_t first_cell, std::size_t first_point,
                     std::size_t points, GridCells& grid, ImportContext& context);

}  // namespace gs::app
