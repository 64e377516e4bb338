#include "app/formats/vtk/structured_faces.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

using BlockPlace = std::array<std::size_t, 3>;

class StructuredFaces {
 public:
  StructuredFaces(const StructuredBlock& block, const GhostFlags& of_cells, const GhostFlags& of_points, PolyData& data,
                  MeshBuilder& builder)
      : block_(block), of_cells_(of_cells), of_points_(of_points), data_(data), builder_(builder) {}

  std::vector<std::size_t> run() {
    std::size_t wide = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (block_.points[axis] > 1) wide_[wide++] = axis;
    if (wide == 1) add_line(wide_[0]);
    if (wide == 2) each_cell([this](const BlockPlace& cell) { add_face(cell, flat_axis(), 0); });
    if (wide == 3) each_cell([this](const BlockPlace& cell) { add_outer_faces(cell); });
    return std::move(owners_);
  }

 private:
  template <class Take>
  void each_cell(Take take) {
    BlockPlace cell{};
    for (cell[2] = 0; cell[2] < block_.cells(2); ++cell[2])
      for (cell[1] = 0; cell[1] < block_.cells(1); ++cell[1]) {
        builder_.draw(0);
        for (cell[0] = 0; cell[0] < block_.cells(0); ++cell[0])
          if (is_visible(cell)) take(cell);
      }
  }
  [[nodiscard]] std::size_t flat_axis() const { return 3 - wide_[0] - wide_[1]; }
  [[nodiscard]] std::size_t cell_number(const BlockPlace& cell) const {
    return (cell[2] * block_.cells(1) + cell[1]) * block_.cells(0) + cell[0];
  }
  [[nodiscard]] std::size_t point_number(const BlockPlace& point) const {
    return (point[2] * block_.points[1] + point[1]) * block_.points[0] + point[0];
  }
  [[nodiscard]] bool is_visible(const BlockPlace& cell) const {
    const std::size_t number = cell_number(cell);
    if (number < of_cells_.size() && is_hidden_cell(of_cells_[number])) return false;
    for (std::size_t corner = 0; corner < 8 && !of_points_.empty(); ++corner) {
      BlockPlace point = cell;
      for (std::size_t axis = 0; axis < 3; ++axis)
        if ((corner >> axis & 1) != 0 && block_.points[axis] > 1) ++point[axis];
      const std::size_t at = point_number(point);
      if (at < of_points_.size() && is_hidden_point(of_points_[at])) return false;
    }
    return true;
  }
  void add_outer_faces(const BlockPlace& cell) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t side = 0; side < 2; ++side) {
        BlockPlace next = cell;
        const bool border = side == 0 ? cell[axis] == 0 : cell[axis] + 1 == block_.cells(axis);
        if (!border) next[axis] += side == 0 ? std::size_t(-1) : 1;
        if (border || !is_visible(next)) add_face(cell, axis, side);
      }
  }
  /// Adds the face of a cell at one side of an axis, counterclockwise from outside if the axes are right-handed.
  void add_face(const BlockPlace& cell, std::size_t axis, std::size_t side) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    BlockPlace corner = cell;
    corner[axis] += side;
    std::array<std::size_t, 4> corners{};
    corners[0] = point_number(corner);
    ++corner[u];
    corners[1] = point_number(corner);
    ++corner[v];
    corners[2] = point_number(corner);
    --corner[u];
    corners[3] = point_number(corner);
    if (side == 0 && wide_[2] != 0) std::swap(corners[1], corners[3]);
    PolyCells& polygons = data_.cells[PolyData::polygons];
    if (owners_.size() % kBetweenCharges == 0)
      builder_.draw(kBetweenCharges * (4 * sizeof(std::int32_t) + 2 * sizeof(std::size_t)));
    for (const std::size_t point : corners) polygons.corners.push_back(static_cast<std::int32_t>(block_.first + point));
    polygons.ends.push_back(polygons.corners.size());
    owners_.push_back(cell_number(cell));
  }
  void add_line(std::size_t axis) {
    PolyCells& lines = data_.cells[PolyData::lines];
    builder_.draw(block_.points[axis] * sizeof(std::int32_t));
    for (std::size_t i = 0; i < block_.points[axis]; ++i)
      lines.corners.push_back(static_cast<std::int32_t>(block_.first + i));
    lines.ends.push_back(lines.corners.size());
  }

  static constexpr std::size_t kBetweenCharges = 4096;

  const StructuredBlock& block_;
  const GhostFlags &of_cells_, &of_points_;
  PolyData& data_;
  MeshBuilder& builder_;
  std::array<std::size_t, 3> wide_{};  // axes with more than one point; 0 behind them
  std::vector<std::size_t> owners_;
};

}  // namespace

std::vector<std::size_t> add_structured_faces(const StructuredBlock& block, const GhostFlags& of_cells,
                                              const GhostFlags& of_points, PolyData& data, MeshBuilder& builder) {
  return StructuredFaces(block, of_cells, of_points, data, builder).run();
}

}  // namespace gs::app
