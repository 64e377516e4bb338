#include "app/formats/vtk/bookkeeping.h"

#include <algorithm>
#include <cstddef>
#include <span>
#include <type_traits>
#include <utility>

namespace gs::app {
namespace {

bool has_hidden_point(std::span<const std::int32_t> corners, const GhostFlags& of_points) {
  if (of_points.empty()) return false;
  return std::ranges::any_of(corners, [&](std::int32_t corner) {
    const auto at = static_cast<std::size_t>(corner);
    return corner >= 0 && at < of_points.size() && is_hidden_point(of_points[at]);
  });
}

}  // namespace

// Flags of vtkDataSetAttributes.h.
bool is_hidden_cell(std::uint8_t flags) {
  constexpr std::uint8_t kCopy = 1, kRefined = 8, kHidden = 32;
  return (flags & (kCopy | kRefined | kHidden)) != 0;
}
bool is_hidden_point(std::uint8_t flags) {
  constexpr std::uint8_t kHidden = 2;
  return (flags & kHidden) != 0;
}

void hide_cells(const GhostFlags& of_cells, const GhostFlags& of_points, GridCells& grid) {
  if (of_cells.empty() && of_points.empty()) return;
  constexpr std::uint8_t kEmptyCell = 0;  // number in vtkCellType.h
  for (std::size_t i = 0; i < grid.types.size() && i < grid.cells.ends.size(); ++i) {
    const std::size_t begin = i == 0 ? 0 : grid.cells.ends[i - 1];
    const auto corners = std::span(grid.cells.corners).subspan(begin, grid.cells.ends[i] - begin);
    const bool hidden = (i < of_cells.size() && is_hidden_cell(of_cells[i])) ||
                        (grid.types[i] != kGridPolyhedron && has_hidden_point(corners, of_points));
    if (hidden) grid.types[i] = kEmptyCell;
  }
}

void remove_hidden_cells(const GhostFlags& of_cells, const GhostFlags& of_points, PolyCells& cells,
                         PolyData::Data& data) {
  if (of_cells.empty() && of_points.empty()) return;
  PolyCells kept;
  PolyData::Data kept_data;
  kept_data.title = data.title;
  std::size_t begin = 0;
  for (std::size_t i = 0; i < cells.ends.size(); ++i) {
    const auto corners = std::span(cells.corners).subspan(begin, cells.ends[i] - begin);
    begin = cells.ends[i];
    if ((i < of_cells.size() && is_hidden_cell(of_cells[i])) || has_hidden_point(corners, of_points)) continue;
    kept.corners.insert(kept.corners.end(), corners.begin(), corners.end());
    kept.ends.push_back(kept.corners.size());
    if (i < data.values.size()) kept_data.values.push_back(data.values[i]);
    if (i < data.colors.size()) kept_data.colors.push_back(data.colors[i]);
  }
  cells = std::move(kept);
  data = std::move(kept_data);
}

void remove_hidden_cells(const GhostFlags& of_cells, const GhostFlags& of_points, PolyData& data) {
  if (of_cells.empty() && of_points.empty()) return;
  PolyData::Data kept;
  kept.title = data.of_cells.title;
  std::size_t at = 0;
  const auto part_of = [&at](const auto& all, std::size_t count) {
    const std::size_t first = std::min(at, all.size()), last = std::min(at + count, all.size());
    return std::decay_t<decltype(all)>(all.begin() + static_cast<std::ptrdiff_t>(first),
                                       all.begin() + static_cast<std::ptrdiff_t>(last));
  };
  for (PolyCells& cells : data.cells) {
    const std::size_t count = cells.ends.size();
    PolyData::Data part{part_of(data.of_cells.values, count), part_of(data.of_cells.colors, count), {}};
    remove_hidden_cells(part_of(of_cells, count), of_points, cells, part);
    kept.values.insert(kept.values.end(), part.values.begin(), part.values.end());
    kept.colors.insert(kept.colors.end(), part.colors.begin(), part.colors.end());
    at += count;
  }
  data.of_cells = std::move(kept);
}

}  // namespace gs::app
