#pragma once

#include "app/formats/vtk/grid_cells.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::app {

/// Face arrays of the polyhedra in one piece of a VTK XML file. Negative or too large numbers are kBadIndex.
struct PolyhedronArrays {
  bool numbered = false;
  std::vector<std::int32_t> ends;  // end of each cell in `faces`; arbitrary for cells that are no polyhedra
  /// Content of the cells. If `numbered`, face indices. Otherwise, the number of faces of the cell, then each face: its
  /// number of corners and the corners.
  std::vector<std::int32_t> faces;
  std::vector<std::int32_t> face_ends, corners;  // if `numbered`: end of each face in `corners`; corners of all faces
};

/// Returns the largest index except kBadIndex; 0 if there is none.
[[nodiscard]] std::size_t greatest_index(std::span<const std::int32_t> indices);
/// Returns the number of faces that an array needs to contain all `numbers`.
[[nodiscard]] std::size_t faces_below(std::span<const std::int32_t> numbers);

/// Adds faces to the polyhedra of `grid` from cell `first_cell` on, in the layout of GridCells. A cell with missing
/// faces becomes empty. Adds `first_point` to the corners; the piece has `points` points. Throws OutOfBudget.
void place_polyhedra(const PolyhedronArrays& arrays, std::size_t first_cell, std::size_t first_point,
                     std::size_t points, GridCells& grid, ImportContext& context);

}  // namespace gs::app
