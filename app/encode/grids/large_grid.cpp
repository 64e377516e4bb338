#include "app/encode/grids/large_grid.h"

#include "app/base/local_file.h"
#include "app/encode/grids/grid_sources.h"
#include "app/formats/common/import_context.h"
#include "app/formats/vtk/bookkeeping.h"
#include "app/formats/vtk/grid_cells.h"
#include "app/formats/vtk/poly_data.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <system_error>
#include <utility>

namespace gs::app {
namespace {

// Memory of an importer: bytes per face of a cell, per corner, and per point (app/formats/vtk/grid_cells.cpp).
constexpr double kFaceBytes = 120, kCornerBytes = 8, kPointBytes = 40;

// Returns the bytes that an importer needs to find the surface. Assumes hexahedra, because it does not read the types.
double import_bytes(const LargeGrid& grid) {
  double bytes = 0;
  for (std::size_t i = 0; i < grid.parts.size(); ++i)
    bytes += static_cast<double>(grid.own_points(i)) * kPointBytes +
             static_cast<double>(grid.parts[i].cells) * (6 * kFaceBytes + 8 * kCornerBytes);
  return bytes;
}

}  // namespace

GridFile GridFile::find(const std::string& grid, const std::string& name, std::uint64_t size) {
  const std::size_t slash = grid.rfind('/');
  GridFile file;
  file.size = size;
  if (name.empty())
    file.path = grid;
  else if (name.starts_with('/') || slash == std::string::npos)
    file.path = name;
  else
    file.path = grid.substr(0, slash + 1) + name;
  std::error_code error;
  if (std::string found = existing_path(file.path); !found.empty()) file.path = std::move(found);
  file.changed_at = std::filesystem::last_write_time(file.path, error);
  return file;
}

bool GridFile::is_changed() const {
  std::error_code error;
  return std::filesystem::file_size(path, error) != size || error ||
         std::filesystem::last_write_time(path, error) != changed_at || error;
}

std::string GridFile::state() const {
  return std::to_string(size) + " " + std::to_string(changed_at.time_since_epoch().count());
}

std::uint64_t LargeGrid::own_points(std::size_t part) const {
  return part > 0 && parts[part - 1].space == parts[part].space ? 0 : parts[part].points;
}

std::optional<LargeGrid> open_large_grid(const VolumeFile& file, std::uint64_t memory) {
  const bool needs_all =
      file.component.colors.range == SurfaceColors::Range::contrast || file.component.flow != FlowForm::values;
  if (needs_all) return std::nullopt;
  auto grid = open_vtk_grid(file, memory);
  if (!grid) grid = open_array_grid(file, memory);
  if (!grid || import_bytes(*grid) <= static_cast<double>(memory)) return std::nullopt;
  grid->choice = file.component;
  std::uint64_t runs = 0;
  // A small file may state any number of points and cells.
  for (std::size_t i = 0; i < grid->parts.size(); ++i)
    runs += 1 + std::max(grid->own_points(i), grid->parts[i].cells) / LargeGrid::kRunCells;
  if (runs > LargeGrid::kMostRuns) return std::nullopt;
  for (std::uint32_t part = 0; part < grid->parts.size(); ++part)
    for (std::uint64_t first = 0; first < grid->parts[part].cells; first += LargeGrid::kRunCells)
      grid->runs.push_back(
          {part, static_cast<std::uint32_t>(std::min(LargeGrid::kRunCells, grid->parts[part].cells - first)), first});
  return grid;
}

std::variant<std::unique_ptr<GridPartReader>, std::string> GridPartReader::open(const LargeGrid& grid,
                                                                                std::size_t part) {
  auto opened = grid.source->open(part);
  if (const auto* const problem = std::get_if<std::string>(&opened)) return grid.source->message(part, *problem);
  return std::unique_ptr<GridPartReader>(new GridPartReader(grid, part, std::move(std::get<GridPartArrays>(opened))));
}

bool GridPartReader::values(std::uint64_t first, std::span<double> to) {
  std::array<double, kMostGridComponents> parts{};
  const std::size_t components = arrays_.components, width = this->width();
  const std::span<double> row = std::span(parts).first(components);
  if (components == 1) return arrays_.values->read(first, to);
  for (; to.size() >= width; to = to.subspan(width), ++first) {
    if (!arrays_.values->read(first * components, row)) return false;
    if (arrays_.colors)
      std::copy_n(row.begin(), width, to.begin());
    else
      to[0] = shown_number(row, grid_.choice);
  }
  return true;
}

// Reads the ends of the cells of a run, relative to their first corner. Sets `first` to the number of that corner.
std::optional<std::string> GridPartReader::read_ends(const LargeGrid::Run& run, std::size_t most_corners, double& first,
                                                     GridRun& cells) {
  if (arrays_.element_corners > 0) {
    first = static_cast<double>(run.first * arrays_.element_corners);
    for (std::size_t i = 1; i <= run.cells; ++i) cells.ends.push_back(i * arrays_.element_corners);
    return std::nullopt;
  }
  std::vector<double> numbers(run.cells);
  if ((run.first > 0 && !arrays_.ends->read(run.first - 1, std::span(&first, 1))) ||
      !arrays_.ends->read(run.first, numbers))
    return std::string("the offsets of cells are damaged");
  double last = first;
  for (const double end : numbers) {
    if (!(last >= 0 && end >= last && end <= static_cast<double>(arrays_.corners->size())))
      return std::string("the offsets of cells are missing or not ascending");
    if (end - first > static_cast<double>(most_corners))
      return "more than " + std::to_string(most_corners) + " corners in " + std::to_string(run.cells) +
             " cells exceed --memory; expected fewer, or a larger --memory";
    last = end;
    cells.ends.push_back(static_cast<std::size_t>(end - first));
  }
  return std::nullopt;
}

std::variant<GridRun, std::string> GridPartReader::cells(const LargeGrid::Run& run, std::size_t most_corners) {
  GridRun cells;
  std::vector<double> numbers(run.cells);
  if (!arrays_.types)
    cells.types.assign(run.cells, arrays_.element);
  else if (!arrays_.types->read(run.first, numbers))
    return std::string("the types of cells are damaged");
  for (std::size_t i = 0; arrays_.types && i < run.cells; ++i) {
    const bool known =
        numbers[i] >= 0 && numbers[i] < 256 && !(arrays_.omits_polyhedra && numbers[i] == kGridPolyhedron);
    cells.types.push_back(known ? static_cast<std::uint8_t>(numbers[i]) : std::uint8_t{255});
  }
  double first = 0;
  if (auto problem = read_ends(run, most_corners, first, cells)) return std::move(*problem);
  numbers.resize(cells.ends.back());
  if (!arrays_.corners->read(static_cast<std::uint64_t>(first), numbers))
    return std::string("the connectivity of cells is damaged");
  for (const double corner : numbers)
    cells.corners.push_back(
        corner >= 0 && corner < static_cast<double>(part_.points) ? static_cast<std::int32_t>(corner) : kBadIndex);
  if (auto problem = hide(run, cells)) return std::move(*problem);
  return cells;
}

// Sets the type of hidden cells, and of cells with hidden points, to 0 (empty), like hide_cells().
std::optional<std::string> GridPartReader::hide(const LargeGrid::Run& run, GridRun& cells) {
  const auto flag_of = [](double value, bool old) {
    const auto stored = value > 0 && value < 256 ? static_cast<std::uint8_t>(value) : std::uint8_t{0};
    return old && stored > 0 ? std::uint8_t{1} : stored;
  };
  if (arrays_.cell_flags) {
    std::vector<double> flags(run.cells);
    if (!arrays_.cell_flags->read(run.first, flags)) return std::string("the flags of hidden cells are damaged");
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (is_hidden_cell(flag_of(flags[i], arrays_.old_flags))) cells.types[i] = 0;
  }
  if (!arrays_.point_flags) return std::nullopt;
  // Reads the flags in the order of the file, because cells may name points in any order.
  std::vector<std::int32_t> points, hidden;
  std::ranges::copy_if(cells.corners, std::back_inserter(points), [](std::int32_t one) { return one != kBadIndex; });
  std::ranges::sort(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  for (const std::int32_t point : points) {
    double flag = 0;
    if (!arrays_.point_flags->read(static_cast<std::uint64_t>(point), std::span(&flag, 1)))
      return std::string("the flags of hidden points are damaged");
    if (is_hidden_point(flag_of(flag, false))) hidden.push_back(point);
  }
  const auto is_hidden = [&](std::int32_t corner) { return std::ranges::binary_search(hidden, corner); };
  for (std::size_t i = 0; i < cells.types.size() && !hidden.empty(); ++i)
    if (cells.types[i] != kGridPolyhedron && std::ranges::any_of(cells.cell(i), is_hidden)) cells.types[i] = 0;
  return std::nullopt;
}

std::variant<GridPartReader*, std::string> LargeGridReader::part(std::size_t number) {
  if (open_ && number_ == number) return open_.get();
  open_ = nullptr;
  auto opened = GridPartReader::open(grid_, number);
  if (auto* const problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  open_ = std::move(std::get<std::unique_ptr<GridPartReader>>(opened));
  number_ = number;
  return open_.get();
}

}  // namespace gs::app
