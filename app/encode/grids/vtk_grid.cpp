#include "app/encode/grids/grid_array.h"
#include "app/encode/grids/grid_sources.h"
#include "app/formats/datasets/vtk/vtk_datasets.h"
#include "app/formats/datasets/vtk/vtk_index.h"
#include "app/formats/vtk/bookkeeping.h"
#include "app/formats/vtk/poly_data.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

const VtkArray* array_in(const VtkXmlHeader& header, std::size_t piece, VtkSection section, std::string_view name) {
  for (const VtkArray& array : header.arrays)
    if (array.piece == piece && array.section == section && (name.empty() || array.name == name)) return &array;
  return nullptr;
}

bool has_usual_components(const VtkArray& array) {
  return array.components > 0 && array.components <= kMostGridComponents;
}

bool stores_colors(const VtkArray& array, const VoxelComponent& choice) {
  return array.type == "uint8" && (array.components == 3 || array.components == 4) && !choice.chosen;
}

// Returns the title of the values of an array, for a colour key. Returns an empty title for colours, and for too many
// components.
std::string title_of_values(const VtkArray& array, const VoxelComponent& choice) {
  if (!has_usual_components(array) || stores_colors(array, choice)) return {};
  return array.name.substr(0, 80) + part_text(static_cast<std::size_t>(array.components), choice) +
         (array.units.empty() ? "" : " (" + array.units + ")");
}

// Returns the message of a file error without the path, which message() or its caller adds.
std::string without_path(std::string text, const std::string& path) {
  if (const std::size_t at = text.find(" " + path); at != std::string::npos) text.erase(at, path.size() + 1);
  return text;
}

/// Grid of VTK XML files.
class VtkGrid final : public GridSource {
 public:
  /// Piece of a file.
  struct Piece {
    std::size_t file = 0, piece = 0;  // in the list of files; in the header of the file
    std::uint64_t points = 0, cells = 0;
  };

  VtkGrid(const std::string& path, VtkPartFiles files, std::vector<Piece> pieces, VoxelComponent choice)
      : files_(std::move(files)), pieces_(std::move(pieces)), choice_(std::move(choice)) {
    for (const VtkPartFile& file : files_.files) on_disk_.push_back(GridFile::find(path, file.path, file.size));
  }

  [[nodiscard]] bool is_changed(std::size_t part) const override { return on_disk_[pieces_[part].file].is_changed(); }
  [[nodiscard]] std::string state() const override {
    std::string state;
    for (const GridFile& file : on_disk_) state += file.state() + "\n";
    return state;
  }
  [[nodiscard]] std::string message(std::size_t part, const std::string& text) const override {
    const std::size_t file = pieces_[part].file;
    return files_.files[file].path.empty() ? text : on_disk_[file].path + ": " + text;
  }

  [[nodiscard]] std::variant<GridPartArrays, std::string> open(std::size_t part) const override {
    const GridFile& on_disk = on_disk_[pieces_[part].file];
    auto opened = net::open_file(on_disk.path);
    if (auto* const problem = std::get_if<net::FileError>(&opened))
      return without_path(std::move(problem->message), on_disk.path);
    const auto file = std::make_shared<const net::RandomAccessFile>(std::move(std::get<net::RandomAccessFile>(opened)));
    if (file->size() != on_disk.size)
      return std::string("another program changed the file, or it is compressed; expected a plain file");
    if (on_disk.is_changed()) return std::string(kChangedGridFile);
    return Opening{*this, pieces_[part], file}.arrays();
  }

  /// Returns the title of the shown array in the first piece that has it. Returns an empty title for colours or none.
  [[nodiscard]] std::string title() const {
    const VtkShownArray& shown = files_.shown;
    for (const Piece& piece : pieces_)
      for (const VtkArray& array : header_of(piece).arrays)
        if (!shown.name.empty() && array.piece == piece.piece && array.section == shown.section &&
            array.name == shown.name)
          return title_of_values(array, choice_);
    return {};
  }

 private:
  /// Arrays of a piece that is being opened.
  struct Opening {
    const VtkGrid& grid;
    const Piece& piece;
    std::shared_ptr<const net::RandomAccessFile> file;

    [[nodiscard]] std::variant<GridPartArrays, std::string> arrays() const;
    std::optional<std::string> open(VtkSection section, std::string_view name, std::uint64_t numbers,
                                    std::unique_ptr<GridNumbers>& to) const;
    std::optional<std::string> open_flags(VtkSection section, std::string_view name, std::uint64_t rows,
                                          std::unique_ptr<GridNumbers>& to) const;
  };
  [[nodiscard]] const VtkXmlHeader& header_of(const Piece& piece) const { return files_.files[piece.file].header; }

  VtkPartFiles files_;
  std::vector<GridFile> on_disk_;  // one for each of files_.files
  std::vector<Piece> pieces_;
  VoxelComponent choice_;
};

std::optional<std::string> VtkGrid::Opening::open(VtkSection section, std::string_view name, std::uint64_t numbers,
                                                  std::unique_ptr<GridNumbers>& to) const {
  const VtkXmlHeader& header = grid.header_of(piece);
  const VtkArray* const array = array_in(header, piece.piece, section, name);
  if (!array) return "a piece has no array '" + std::string(name) + "'; expected points and cells";
  auto opened = GridArray::open(file, header, *array, numbers);
  if (auto* const problem = std::get_if<std::string>(&opened)) return std::move(*problem);
  to = std::make_unique<GridArray>(std::move(std::get<GridArray>(opened)));
  return std::nullopt;
}

std::optional<std::string> VtkGrid::Opening::open_flags(VtkSection section, std::string_view name, std::uint64_t rows,
                                                        std::unique_ptr<GridNumbers>& to) const {
  const VtkArray* const array = array_in(grid.header_of(piece), piece.piece, section, name);
  return array && array->components == 1 ? open(section, name, rows, to) : std::nullopt;
}

std::variant<GridPartArrays, std::string> VtkGrid::Opening::arrays() const {
  const VtkXmlHeader& header = grid.header_of(piece);
  GridPartArrays made;
  const VtkArray* const places = array_in(header, piece.piece, VtkSection::points, {});
  if (!places || places->components != 3) return std::string("a piece has no Points with three components");
  made.wide = places->type == "float64";
  if (auto problem = open(VtkSection::points, {}, 3 * piece.points, made.points)) return *problem;
  if (auto problem = open(VtkSection::cells, "types", piece.cells, made.types)) return *problem;
  if (auto problem = open(VtkSection::cells, "offsets", piece.cells, made.ends)) return *problem;
  double corners = 0;
  if (!made.ends->read(piece.cells - 1, std::span(&corners, 1)) || !(corners >= 0 && corners < 1e15))
    return std::string("the offsets of cells are damaged");
  if (auto problem = open(VtkSection::cells, "connectivity", static_cast<std::uint64_t>(corners), made.corners))
    return *problem;
  if (auto problem = open_flags(VtkSection::point_data, kGhostArray, piece.points, made.point_flags)) return *problem;
  if (auto problem = open_flags(VtkSection::cell_data, kGhostArray, piece.cells, made.cell_flags)) return *problem;
  made.old_flags = !made.cell_flags;
  if (made.old_flags)
    if (auto problem = open_flags(VtkSection::cell_data, kOldGhostArray, piece.cells, made.cell_flags)) return *problem;
  const VtkShownArray& shown = grid.files_.shown;
  const VtkArray* const array = shown.name.empty() ? nullptr : array_in(header, piece.piece, shown.section, shown.name);
  if (!array || !has_usual_components(*array)) return made;
  made.components = static_cast<std::size_t>(array->components);
  made.of_points = shown.section == VtkSection::point_data;
  made.colors = stores_colors(*array, grid.choice_);
  if (auto problem =
          open(shown.section, shown.name, (made.of_points ? piece.points : piece.cells) * made.components, made.values))
    return *problem;
  return made;
}

}  // namespace

std::optional<LargeGrid> open_vtk_grid(const VolumeFile& file, std::uint64_t memory) {
  const std::span<const std::byte> bytes = file.content.bytes;
  const VtkFileClass kind = vtk_class_of(bytes);
  const bool names_others = kind == VtkFileClass::pieces || kind == VtkFileClass::blocks || kind == VtkFileClass::steps;
  const bool large = kind == VtkFileClass::leaf && may_exceed(bytes.size(), memory);
  if (!large && !names_others) return std::nullopt;
  if (kind != VtkFileClass::blocks && kind != VtkFileClass::steps && !is_vtk_xml_or_pieces(bytes, "UnstructuredGrid"))
    return std::nullopt;
  auto files = vtk_grid_files(file);
  if (!files) return std::nullopt;
  LargeGrid grid;
  grid.shows_values = !files->shown.name.empty();
  std::vector<VtkGrid::Piece> pieces;
  std::uint64_t least_runs = 0;
  for (std::size_t i = 0; i < files->files.size(); ++i) {
    if (!files->files[i].path.empty()) grid.other_bytes += files->files[i].size;
    const VtkXmlHeader& header = files->files[i].header;
    for (std::size_t piece = 0; piece < header.pieces.size(); ++piece) {
      const VtkPiece& from = header.pieces[piece];
      if (from.points >= kMostGridPoints || from.cells >= kMostGridPoints) return std::nullopt;
      if (from.points == 0 || from.cells == 0) continue;
      // A small file may state any number of cells.
      least_runs += 1 + std::max(from.points, from.cells) / LargeGrid::kRunCells;
      if (least_runs > LargeGrid::kMostRuns) return std::nullopt;
      grid.parts.push_back({from.points, from.cells, static_cast<std::uint32_t>(pieces.size())});
      pieces.push_back({i, piece, from.points, from.cells});
    }
  }
  auto source = std::make_shared<VtkGrid>(file.path, std::move(*files), std::move(pieces), file.component);
  grid.title = source->title();
  grid.source = std::move(source);
  return grid;
}

}  // namespace gs::app
