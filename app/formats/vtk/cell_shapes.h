#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::app {

inline constexpr std::int8_t kNoGridCorner = -1;
/// Corners of a face by their numbers in the cell. Triangles end with kNoGridCorner.
using GridFaceCorners = std::array<std::int8_t, 4>;

/// Shape as which cells of a type are drawn.
struct GridShape {
  enum class As : std::uint8_t { nothing, vertices, line, polygon, pixel, strip, solid, polyhedron } as = As::nothing;
  std::size_t corners = 0;  // min number of corners of a cell
  bool any_number = false;  // if true, uses all corners of the cell; else the first `corners`
  std::span<const GridFaceCorners> faces = {};
};

/// Returns the shape for a type number of vtkCellType.h. Nodes on edges and inside the cell come after the corners.
[[nodiscard]] GridShape grid_shape(std::uint8_t type);

}  // namespace gs::app
