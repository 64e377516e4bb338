#pragma once

#include "app/formats/vtk/poly_data.h"

#include <cstdint>
#include <vector>

namespace gs::app {

inline constexpr std::uint8_t kGridPolyhedron = 42;  // number in vtkCellType.h

/// Cells of a VTK UnstructuredGrid, in the layout of legacy files. Invalid corners are kBadIndex. A polyhedron begins
/// with its number of faces. Each face is its number of corners, then the corners. No number is negative.
struct GridCells {
  std::vector<std::uint8_t> types;  // type numbers of vtkCellType.h, one per cell
  PolyCells cells;
};

/// Adds the visible parts of the cells to `data`, which already holds their points. These are vertices, lines,
/// polygons, strips, and outer faces of solid cells. A face is outer if only one cell has it. Data of grid cells become
/// data of the added parts. Higher-order cells use only their corners. Skips other cell types with a warning. Throws
/// OutOfBudget.
void add_grid(const GridCells& grid, PolyData& data, MeshBuilder& builder);

}  // namespace gs::app
