#include "app/encode/grids/large_grid.h"

#include "app/base/local_file.h"
#include "app/formats/common/import_context.h"
#include "app/formats/datasets/vtk/vtk_index.h"
#include "app/formats/vtk/bookkeeping.h"

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

namespace gs::app {
namespace {

// Memory of an importer: bytes per face of a cell, per corner, and per point (app/formats/vtk/grid_cells.cpp).
constexpr double kFaceBytes = 120, kCornerBytes = 8, kPointBytes = 40;
constexpr std::uint64_t kMostGridPoints = static_cast<std::uint64_t>(kBadIndex);  // of a part
constexpr std::size_t kMostComponents = 64;
// Maximum number of parts and runs, for lists of at most 256 MB.
constexpr std::uint64_t kMostGridRuns = std::uint64_t{1} << 22;

const VtkArray* array_in(const VtkXmlHeader& header, std::size_t piece, VtkSection section, std::string_view name) {
  for (const VtkArray& array : header.arrays)
    if (array.piece == piece && array.section == section && (name.empty() || array.name == name)) return &array;
  return nullptr;
}

// Returns the bytes that an importer needs to find the surface. Assumes hexahedra, because it does not read the types.
double import_bytes(const LargeGrid& grid) {
  double bytes = 0;
  for (const LargeGrid::Part& part : grid.parts)
    bytes += static_cast<double>(part.points) * kPointBytes +
             static_cast<double>(part.cells) * (6 * kFaceBytes + 8 * kCornerBytes);
  return bytes;
}

// Returns the file of a grid on disk. Ignores upper and lower case as the reader of the headers does.
LargeGrid::File file_on_disk(const std::string& grid, const std::string& name) {
  const std::size_t slash = grid.rfind('/');
  LargeGrid::File file;
  if (name.empty())
    file.path = grid;
  else if (name.starts_with('/') || slash == std::string::npos)
    file.path = name;
  else
    file.path = grid.substr(0, slash + 1) + name;
  std::error_code error;
  if (std::string found = existing_path(file.path); !found.empty()) file.path = std::move(found);
  file.changed = std::filesystem::last_write_time(file.path, error);
  return file;
}

bool has_usual_components(const VtkArray& array) { return array.components > 0 && array.components <= kMostComponents; }

}  // namespace

bool stores_colors(const VtkArray& array, const VoxelComponent& choice) {
  return array.type == "uint8" && (array.components == 3 || array.components == 4) && !choice.chosen;
}

std::string title_of_values(const VtkArray& array, const VoxelComponent& choice) {
  if (!has_usual_components(array) || stores_colors(array, choice)) return {};
  return array.name.substr(0, 80) + part_text(static_cast<std::size_t>(array.components), choice) +
         (array.units.empty() ? "" : " (" + array.units + ")");
}

bool LargeGrid::is_changed(std::size_t file) const {
  std::error_code error;
  const File& own = on_disk[file];
  return std::filesystem::file_size(own.path, error) != files.files[file].size || error ||
         std::filesystem::last_write_time(own.path, error) != own.changed || error;
}

std::string LargeGrid::message(std::size_t file, const std::string& text) const {
  return files.files[file].path.empty() ? text : on_disk[file].path + ": " + text;
}

std::optional<LargeGrid> open_large_grid(const VolumeFile& file, std::uint64_t memory) {
  const bool needs_all =
      file.component.colors.range == SurfaceColors::Range::contrast || file.component.flow != FlowForm::values;
  const std::span<const std::byte> bytes = file.content.bytes;
  const VtkFileClass kind = vtk_class_of(bytes);
  const bool names_others = kind == VtkFileClass::pieces || kind == VtkFileClass::blocks || kind == VtkFileClass::steps;
  // Assumes that an importer needs at most 8 times the bytes of a file. So small files are not parsed twice.
  constexpr std::uint64_t kLeastShare = 8;
  const bool large = kind == VtkFileClass::leaf && bytes.size() > memory / kLeastShare;
  if (needs_all || !(large || names_others)) return std::nullopt;
  if (kind != VtkFileClass::blocks && kind != VtkFileClass::steps && !is_vtk_xml_or_pieces(bytes, "UnstructuredGrid"))
    return std::nullopt;
  auto files = vtk_grid_files(file);
  if (!files) return std::nullopt;
  LargeGrid grid;
  grid.files = std::move(*files);
  for (const VtkPartFile& one : grid.files.files) grid.on_disk.push_back(file_on_disk(file.path, one.path));
  grid.choice = file.component;
  std::uint64_t runs = 0;
  for (std::size_t i = 0; i < grid.files.files.size(); ++i) {
    const VtkXmlHeader& header = grid.files.files[i].header;
    for (std::size_t piece = 0; piece < header.pieces.size(); ++piece) {
      const VtkPiece& from = header.pieces[piece];
      // Corners of cells are 32-bit numbers of points of the part.
      if (from.points > kMostGridPoints || from.cells > kMostGridPoints) return std::nullopt;
      if (from.points == 0 || from.cells == 0) continue;
      // A small file may state any number of cells.
      runs += 1 + std::max(from.points, from.cells) / LargeGrid::kRunCells;
      if (runs > kMostGridRuns) return std::nullopt;
      grid.parts.push_back({i, piece, from.points, from.cells});
    }
  }
  if (import_bytes(grid) <= static_cast<double>(memory)) return std::nullopt;
  for (std::uint32_t part = 0; part < grid.parts.size(); ++part)
    for (std::uint64_t first = 0; first < grid.parts[part].cells; first += LargeGrid::kRunCells)
      grid.runs.push_back(
          {part, static_cast<std::uint32_t>(std::min(LargeGrid::kRunCells, grid.parts[part].cells - first)), first});
  return grid;
}

std::variant<std::unique_ptr<GridPartReader>, std::string> GridPartReader::open(const LargeGrid& grid,
                                                                                std::size_t part) {
  std::unique_ptr<GridPartReader> reader(new GridPartReader(grid, part));
  const std::size_t file = grid.parts[part].file;
  auto opened = net::open_file(grid.on_disk[file].path);
  if (const auto* const problem = std::get_if<net::FileError>(&opened)) return problem->message;
  reader->file_ = std::make_shared<const net::RandomAccessFile>(std::move(std::get<net::RandomAccessFile>(opened)));
  if (reader->file_->size() != grid.files.files[file].size)
    return grid.message(file, "another program changed the file, or it is compressed; expected a plain file");
  if (grid.is_changed(file)) return grid.message(file, kChangedGridFile);
  if (auto problem = reader->open_arrays()) return grid.message(file, *problem);
  return reader;
}

std::optional<std::string> GridPartReader::open_array(VtkSection section, std::string_view name, std::uint64_t numbers,
                                                      std::optional<GridArray>& to) {
  const VtkXmlHeader& header = grid_.files.files[part_.file].header;
  const VtkArray* const array = array_in(header, part_.piece, section, name);
  if (!array) return "a piece has no array '" + std::string(name) + "'; expected points and cells";
  auto opened = GridArray::open(file_, header, *array, numbers);
  if (auto* const problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  to = std::move(std::get<GridArray>(opened));
  return std::nullopt;
}

std::optional<std::string> GridPartReader::open_arrays() {
  const VtkXmlHeader& header = grid_.files.files[part_.file].header;
  const VtkArray* const places = array_in(header, part_.piece, VtkSection::points, {});
  if (!places || places->components != 3) return std::string("a piece has no Points with three components");
  wide_ = places->type == "float64";
  if (auto problem = open_array(VtkSection::points, {}, 3 * part_.points, points_)) return problem;
  if (auto problem = open_array(VtkSection::cells, "types", part_.cells, types_)) return problem;
  if (auto problem = open_array(VtkSection::cells, "offsets", part_.cells, ends_)) return problem;
  std::array<double, 1> corners{};
  if (!ends_->read(part_.cells - 1, corners) || !(corners[0] >= 0 && corners[0] < 1e15))
    return std::string("the offsets of cells are damaged");
  if (auto problem = open_array(VtkSection::cells, "connectivity", static_cast<std::uint64_t>(corners[0]), corners_))
    return problem;
  const auto flags = [&](VtkSection section, std::string_view name, std::uint64_t rows, std::optional<GridArray>& to) {
    const VtkArray* const array = array_in(header, part_.piece, section, name);
    return array && array->components == 1 ? open_array(section, name, rows, to) : std::nullopt;
  };
  if (auto problem = flags(VtkSection::point_data, kGhostArray, part_.points, point_flags_)) return problem;
  if (auto problem = flags(VtkSection::cell_data, kGhostArray, part_.cells, cell_flags_)) return problem;
  old_flags_ = !cell_flags_;
  if (old_flags_)
    if (auto problem = flags(VtkSection::cell_data, kOldGhostArray, part_.cells, cell_flags_)) return problem;
  const VtkShownArray& shown = grid_.files.shown;
  const VtkArray* const array = shown.name.empty() ? nullptr : array_in(header, part_.piece, shown.section, shown.name);
  if (!array || !has_usual_components(*array)) return std::nullopt;
  components_ = static_cast<std::size_t>(array->components);
  of_points_ = shown.section == VtkSection::point_data;
  colors_ = stores_colors(*array, grid_.choice);
  return open_array(shown.section, shown.name, (of_points_ ? part_.points : part_.cells) * components_, values_);
}

bool GridPartReader::values(std::uint64_t first, std::span<double> to) {
  std::array<double, kMostComponents> parts{};
  const std::span<double> row = std::span(parts).first(components_);
  const std::size_t width = this->width();
  if (components_ == 1) return values_->read(first, to);
  for (; to.size() >= width; to = to.subspan(width), ++first) {
    if (!values_->read(first * components_, row)) return false;
    if (colors_)
      std::copy_n(row.begin(), width, to.begin());
    else
      to[0] = shown_number(row, grid_.choice);
  }
  return true;
}

std::variant<GridRun, std::string> GridPartReader::cells(const LargeGrid::Run& run, std::size_t most_corners) {
  GridRun cells;
  std::vector<double> numbers(run.cells);
  std::array<double, 1> before{};
  if (!types_->read(run.first, numbers)) return std::string("the types of cells are damaged");
  for (const double type : numbers)
    cells.types.push_back(type >= 0 && type < 256 ? static_cast<std::uint8_t>(type) : std::uint8_t{255});
  if ((run.first > 0 && !ends_->read(run.first - 1, before)) || !ends_->read(run.first, numbers))
    return std::string("the offsets of cells are damaged");
  double last = before[0];
  for (const double end : numbers) {
    if (!(last >= 0 && end >= last && end <= static_cast<double>(corners_->size())))
      return std::string("the offsets of cells are missing or not ascending");
    if (end - before[0] > static_cast<double>(most_corners))
      return "more than " + std::to_string(most_corners) + " corners in " + std::to_string(run.cells) +
             " cells exceed --memory; expected fewer, or a larger --memory";
    last = end;
    cells.ends.push_back(static_cast<std::size_t>(end - before[0]));
  }
  numbers.resize(cells.ends.back());
  if (!corners_->read(static_cast<std::uint64_t>(before[0]), numbers))
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
  if (cell_flags_) {
    std::vector<double> flags(run.cells);
    if (!cell_flags_->read(run.first, flags)) return std::string("the flags of hidden cells are damaged");
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (is_hidden_cell(flag_of(flags[i], old_flags_))) cells.types[i] = 0;
  }
  for (std::size_t i = 0; point_flags_ && i < cells.types.size(); ++i)
    for (const std::int32_t corner : cells.cell(i)) {
      std::array<double, 1> flag{};
      if (cells.types[i] == 0 || corner == kBadIndex) continue;
      if (!point_flags_->read(static_cast<std::uint64_t>(corner), flag))
        return std::string("the flags of hidden points are damaged");
      if (is_hidden_point(flag_of(flag[0], false))) cells.types[i] = 0;
    }
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
