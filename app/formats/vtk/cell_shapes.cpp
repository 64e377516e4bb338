#include "app/formats/vtk/cell_shapes.h"

#include "app/formats/vtk/grid_cells.h"

namespace gs::app {
namespace {

// Faces of a cell as corner indices in VTK's order, counterclockwise from outside.
constexpr GridFaceCorners kGridTetrahedron[] = {
    {0, 1, 3, kNoGridCorner}, {1, 2, 3, kNoGridCorner}, {2, 0, 3, kNoGridCorner}, {0, 2, 1, kNoGridCorner}};
constexpr GridFaceCorners kGridHexahedron[] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4},
                                               {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
constexpr GridFaceCorners kGridVoxel[] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                          {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
constexpr GridFaceCorners kGridWedge[] = {
    {0, 1, 2, kNoGridCorner}, {3, 5, 4, kNoGridCorner}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}};
constexpr GridFaceCorners kGridPyramid[] = {{0, 3, 2, 1},
                                            {0, 1, 4, kNoGridCorner},
                                            {1, 2, 4, kNoGridCorner},
                                            {2, 3, 4, kNoGridCorner},
                                            {3, 0, 4, kNoGridCorner}};

}  // namespace

GridShape grid_shape(std::uint8_t type) {
  using As = GridShape::As;
  switch (type) {
    case 1:  // vertex, polyvertex
    case 2:
      return {As::vertices, 1, true};
    case 3:  // line, polyline
    case 4:
      return {As::line, 2, true};
    case 21:  // quadratic, cubic, Lagrange, Bezier; other shapes below follow this order
    case 35:
    case 68:
    case 75:
      return {As::line, 2};
    case 5:
    case 22:
    case 34:
    case 69:
    case 76:
      return {As::polygon, 3};
    case 6:
      return {As::strip, 3, true};
    case 7:
      return {As::polygon, 3, true};
    case 8:
      return {As::pixel, 4};
    case 9:
    case 23:
    case 28:
    case 30:
    case 70:
    case 77:
      return {As::polygon, 4};
    case 10:
    case 24:
    case 71:
    case 78:
      return {As::solid, 4, false, kGridTetrahedron};
    case 11:
      return {As::solid, 8, false, kGridVoxel};
    case 12:
    case 25:
    case 29:
    case 33:
    case 72:
    case 79:
      return {As::solid, 8, false, kGridHexahedron};
    case 13:
    case 26:
    case 31:
    case 32:
    case 73:
    case 80:
      return {As::solid, 6, false, kGridWedge};
    case 14:
    case 27:
    case 37:
    case 74:
    case 81:
      return {As::solid, 5, false, kGridPyramid};
    case kGridPolyhedron:
      return {As::polyhedron, 1, true};
    default:
      return {};
  }
}

}  // namespace gs::app
