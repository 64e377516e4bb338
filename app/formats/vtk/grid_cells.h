#pragma once

#include "app/formats/vtk/poly_data.h"

#include <cstdint>
#include <vector>

namespace gs::app {

inline constexpr std::uint8_t kGridPolyhedron = 42;  // value in vtkCellType.h

/// Cells of a VTK UnstructuredGrid, in the layout of legacy files. Invalid corners are kBadIndex. A polyhedron stores
/// its number of faces, then for each face the number of corners and the corners. No number is negative.
struct GridCells {
  std::vector<std::uint8_t> types;  // vtkCellType.h values, one per cell
  PolyCells cells;
};

/// Adds the visible parts of the cells to `data`, which holds their points: vertices, lines, polygons, strips, and
/// outer faces of solid cells. A face is outer if only one cell has it. Cell data, one per grid cell, become data of
/// the added parts. Of higher-order cells, only the corners are used. Skips other cell types with a warning. Throws
/// OutOfBudget.
void add_grid(const GridCells& grid, PolyData& data, MeshBuilder& builder);

}  // namespace gs::app
