#pragma once

#include "app/formats/vtk/bookkeeping.h"

#include <array>
#include <cstddef>
#include <vector>

namespace gs::app {

/// Block of points in three directions, the first one fastest, from point `first` on.
struct StructuredBlock {
  std::array<std::size_t, 3> points{1, 1, 1};
  std::size_t first = 0;

  [[nodiscard]] std::size_t point_count() const { return points[0] * points[1] * points[2]; }
  /// Returns the cells along a direction; a flat one has a single layer.
  [[nodiscard]] std::size_t cells(std::size_t axis) const { return points[axis] > 1 ? points[axis] - 1 : 1; }
  [[nodiscard]] std::size_t cell_count() const { return cells(0) * cells(1) * cells(2); }
};

/// Adds the outer faces of the visible cells of a block; all cells of a flat one; or a line. Returns the cell of each
/// added polygon. Throws OutOfBudget.
[[nodiscard]] std::vector<std::size_t> add_structured_faces(const StructuredBlock& block, const GhostFlags& of_cells,
                                                            const GhostFlags& of_points, PolyData& data,
                                                            MeshBuilder& builder);

}  // namespace gs::app
