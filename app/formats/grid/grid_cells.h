#pragma once

#include "app/formats/grid/poly_data.h"

#include <cstdint>
#include <vector>

namespace gs::app {

inline constexpr std::uint8_t kGridPolyhedron = 42;  // of vtkCellType.h

/// The cells of what VTK calls UnstructuredGrid, as its legacy files have them: kBadIndex for corners that are none; a
/// polyhedron has in place of its corners how many faces it has, then of each how many corners, and these. No number is
/// negative.
struct GridCells {
  std::vector<std::uint8_t> types;  // numbers of vtkCellType.h, one a cell
  PolyCells cells;
};

/// Adds to `data`, whose points the cells use, what is seen of them from outside: vertices, lines, polygons, strips,
/// and those faces of solid cells that belong to one of them only. Data of cells, one a cell of the grid, become data
/// of what is added. Of cells with nodes on their edges the corners are used; cells of other types are left out with a
/// warning. Throws OutOfBudget.
void add_grid(const GridCells& grid, PolyData& data, SceneBuilder& builder);

}  // namespace gs::app
