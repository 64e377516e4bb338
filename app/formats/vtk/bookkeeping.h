#pragma once

#include "app/formats/vtk/grid_cells.h"
#include "app/formats/vtk/poly_data.h"

#include <cstdint>
#include <string_view>
#include <vector>

// Arrays with which programs hide points and cells (is_bookkeeping() in dataset_list.h knows their names).
namespace gs::app {

/// Flags of hidden points or cells, as vtkGhostType has them. An empty list hides nothing.
using GhostFlags = std::vector<std::uint8_t>;
/// Names of the array with these flags in current and older files. In older files, each number above 0 marks a copy of
/// a cell of another piece.
inline constexpr std::string_view kGhostArray = "vtkGhostType", kOldGhostArray = "vtkGhostLevels";

/// Returns true for the flags of a cell that is not drawn: a copy, a cell with finer cells in its place, or a hidden
/// one.
[[nodiscard]] bool is_hidden_cell(std::uint8_t flags);
/// Returns true for the flags of a hidden point.
[[nodiscard]] bool is_hidden_point(std::uint8_t flags);

/// Empties hidden cells, and cells with hidden points. Their data keep their places.
void hide_cells(const GhostFlags& of_cells, const GhostFlags& of_points, GridCells& grid);
/// Removes hidden cells, and cells with hidden points, with their data.
void remove_hidden_cells(const GhostFlags& of_cells, const GhostFlags& of_points, PolyCells& cells,
                         PolyData::Data& data);
/// Removes the hidden cells of a surface. Flags and data of cells are in the order of the kinds of cells.
void remove_hidden_cells(const GhostFlags& of_cells, const GhostFlags& of_points, PolyData& data);

}  // namespace gs::app
