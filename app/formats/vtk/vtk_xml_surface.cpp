#include "app/formats/common/content_type.h"
#include "app/formats/volume/vtk_xml.h"
#include "app/formats/vtk/grid_cells.h"
#include "app/formats/vtk/poly_data.h"
#include "app/formats/vtk/polyhedra.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

constexpr std::uint64_t kMaxPolyPoints = static_cast<std::uint64_t>(kBadIndex);

class VtpImporter {
 public:
  VtpImporter(std::span<const std::byte> bytes, const VtkXmlHeader& header, MeshBuilder& builder)
      : file_{nullptr, bytes}, header_(header), builder_(builder) {}

  void run() {
    if (header_.piece_count > header_.pieces.size())
      builder_.fail(std::to_string(header_.piece_count) + " pieces; the first " +
                    std::to_string(header_.pieces.size()) + " are read");
    if (!choose()) return;
    for (std::size_t i = 0; i < header_.pieces.size(); ++i) piece(i);
    finish(data_.of_points, data_.points.size());
    std::size_t cells = grid_.types.size();
    for (const PolyCells& one : data_.cells) cells += one.ends.size();
    finish(data_.of_cells, cells);
    if (data_.points.empty()) return builder_.warn("no points in the file");
    if (!grid_.types.empty()) add_grid(grid_, data_, builder_);
    build_poly_data(std::move(data_), builder_);
  }

 private:
  [[nodiscard]] bool is_data(const VtkArray& array) const {
    const bool of_data = array.section == VtkSection::point_data || array.section == VtkSection::cell_data;
    return of_data && vtk_type_of(array.type) && array.components > 0 && !is_normals(array);
  }
  // Lists the arrays, and chooses the one that the user wants, or a usual one. Reports a wrong choice and returns
  // false.
  bool choose() {
    shown_of_points_ = chosen(VtkSection::point_data, header_.point_scalars);
    if (!shown_of_points_) shown_of_cells_ = chosen(VtkSection::cell_data, header_.cell_scalars);
    std::vector<DatasetEntry> entries;
    std::vector<const VtkArray*> arrays;
    std::uint64_t points = 0, cells = 0;
    for (const VtkPiece& piece : header_.pieces) {
      points += piece.points;
      cells += piece.cells + piece.vertices + piece.lines + piece.polygons + piece.strips;
    }
    for (const VtkArray& array : header_.arrays) {
      if (array.piece != 0 || !is_data(array)) continue;
      const bool of_points = array.section == VtkSection::point_data;
      entries.push_back(
          surface_entry(of_points, array.name, of_points ? points : cells, array.components, array.type, array.units));
      arrays.push_back(&array);
    }
    return choose_surface_entry(
        entries, builder_,
        [&](std::size_t entry) {
          const bool of_points = arrays[entry]->section == VtkSection::point_data;
          shown_of_points_ = of_points ? arrays[entry] : nullptr;
          shown_of_cells_ = of_points ? nullptr : arrays[entry];
        },
        shown_of_points_ || shown_of_cells_
            ? entry_path(shown_of_points_ != nullptr, (shown_of_points_ ? shown_of_points_ : shown_of_cells_)->name)
            : std::string());
  }
  // Chooses an array of a section: the array with the name `active`, else the first with one component, else the first.
  [[nodiscard]] const VtkArray* chosen(VtkSection section, const std::string& active) const {
    const VtkArray *single = nullptr, *first = nullptr;
    for (const VtkArray& array : header_.arrays) {
      if (array.section != section || !vtk_type_of(array.type) || array.components == 0 || is_normals(array) ||
          is_bookkeeping(array.name))
        continue;
      if (!active.empty() && array.name == active) return &array;
      if (!single && array.components == 1) single = &array;
      if (!first) first = &array;
    }
    return single ? single : first;
  }
  [[nodiscard]] bool is_normals(const VtkArray& array) const {
    return array.section == VtkSection::point_data && array.components == 3 && array.name == header_.point_normals &&
           !array.name.empty();
  }
  [[nodiscard]] const VtkArray* array_of(std::size_t piece, VtkSection section, std::string_view name) const {
    for (const VtkArray& array : header_.arrays)
      if (array.piece == piece && array.section == section && (name.empty() || array.name == name)) return &array;
    return nullptr;
  }
  // Reads the first `count` numbers of an array. On failure, reports an error and returns nullopt.
  std::optional<StoredVoxels> numbers(const VtkArray& array, std::uint64_t count) {
    auto values = vtk_values(file_, header_, array, count, builder_.budget());
    if (auto* found = std::get_if<StoredVoxels>(&values)) return std::move(*found);
    builder_.fail("the array '" + array.name.substr(0, 80) + "': " + std::get<std::string>(values));
    return std::nullopt;
  }

  void piece(std::size_t number) {
    const VtkPiece& piece = header_.pieces[number];
    if (piece.points == 0) return;
    const std::size_t first = data_.points.size();
    if (piece.points > kMaxPolyPoints - first)
      return builder_.fail("a piece of " + std::to_string(piece.points) + " points; expected less than 2^31 in all");
    const VtkArray* const places = array_of(number, VtkSection::points, {});
    if (!places || places->components != 3) return builder_.fail("a piece has no Points with three components");
    if (!read_vectors(*places, piece.points, data_.points)) return;
    const VtkArray* const normals =
        header_.point_normals.empty() ? nullptr : array_of(number, VtkSection::point_data, header_.point_normals);
    if (normals && normals->components == 3 && data_.normals.size() == first)
      (void)read_vectors(*normals, piece.points, data_.normals);
    if (shown_of_points_) read_data(number, *shown_of_points_, first, piece.points, data_.of_points);
    const std::size_t first_cell = grid_.types.size();
    if (read_grid(number, piece.cells, first) && shown_of_cells_ && piece.cells > 0)
      read_data(number, *shown_of_cells_, first_cell, piece.cells, data_.of_cells);
    const std::pair<VtkSection, std::uint64_t> kinds[] = {{VtkSection::vertices, piece.vertices},
                                                          {VtkSection::lines, piece.lines},
                                                          {VtkSection::polygons, piece.polygons},
                                                          {VtkSection::strips, piece.strips}};
    std::uint64_t cells = 0;
    bool whole = true;
    for (std::size_t kind = 0; kind < PolyData::kKinds; ++kind) {
      cells += kinds[kind].second;
      whole = read_cells(number, kinds[kind].first, kinds[kind].second, first, data_.cells[kind]) && whole;
    }
    // With several pieces, the order of cells differs from the order of cell data.
    if (!shown_of_cells_ || !whole || cells == 0) return;
    if (header_.pieces.size() == 1)
      read_data(number, *shown_of_cells_, 0, cells, data_.of_cells);
    else if (number == 0)
      builder_.note("data of cells in several pieces are not shown");
  }

  bool read_vectors(const VtkArray& array, std::uint64_t count, std::vector<glm::vec3>& to) {
    const auto values = numbers(array, count * 3);
    if (!values) return false;
    builder_.draw(count * sizeof(glm::vec3));
    glm::vec3 vector(0);
    int axis = 0;
    each_number(*values, count * 3, [&](double value) {
      vector[axis] = static_cast<float>(value);
      if (++axis < 3) return;
      to.push_back(vector);
      axis = 0;
    });
    return true;
  }

  // Reads the array of a piece with the same name as `shown`. `first` is the number of points or cells in earlier
  // pieces.
  void read_data(std::size_t piece, const VtkArray& shown, std::size_t first, std::uint64_t count,
                 PolyData::Data& data) {
    const VtkArray* const array = array_of(piece, shown.section, shown.name);
    constexpr std::uint64_t kMaxComponents = 64;
    if (!array || array->components == 0 || array->components > kMaxComponents || count > kMaxPolyPoints) return;
    const auto values = numbers(*array, count * array->components);
    if (!values) return;
    const bool colors =
        array->type == "uint8" && (array->components == 3 || array->components == 4) && !builder_.choice().chosen;
    if (builder_.choice().found) builder_.choice().found->components = array->components;
    builder_.draw(count * (colors ? sizeof(vrml::Color) : sizeof(float)));
    if (data.title.empty())
      data.title = array->name.substr(0, 80) + part_text(array->components, builder_.choice()) +
                   (array->units.empty() ? "" : " (" + array->units + ")");
    if (colors)
      data.colors.resize(first, {0.5f, 0.5f, 0.5f});
    else
      data.values.resize(first, NAN);
    std::array<double, kMaxComponents> parts{};
    std::size_t part = 0;
    each_number(*values, count * array->components, [&](double value) {
      parts[part] = value;
      if (++part < array->components) return;
      part = 0;
      if (colors) {
        const auto share = [&](std::size_t i) { return static_cast<float>(parts[i] / 255); };
        data.colors.emplace_back(share(0), share(1), share(2));
        return;
      }
      data.values.push_back(
          static_cast<float>(shown_number(std::span(parts).first(array->components), builder_.choice())));
    });
  }
  // Fills up data that later pieces lack.
  static void finish(PolyData::Data& data, std::size_t count) {
    if (!data.colors.empty()) data.colors.resize(count, {0.5f, 0.5f, 0.5f});
    if (!data.values.empty()) data.values.resize(count, NAN);
  }

  // Reads the cells of a grid and their types. Returns false if some are missing.
  bool read_grid(std::size_t piece, std::uint64_t count, std::size_t first) {
    if (count == 0) return true;
    const VtkArray* const types = array_of(piece, VtkSection::cells, "types");
    if (!types || count > kMaxPolyPoints) {
      builder_.fail("cells without 'types'");
      return false;
    }
    const auto values = numbers(*types, count);
    if (!values || !read_cells(piece, VtkSection::cells, count, first, grid_.cells)) return false;
    builder_.draw(count);
    bool polyhedra = false;
    each_number(*values, count, [&](double type) {
      grid_.types.push_back(type >= 0 && type < 256 ? static_cast<std::uint8_t>(type) : std::uint8_t{255});
      polyhedra = polyhedra || grid_.types.back() == kGridPolyhedron;
    });
    if (polyhedra) read_polyhedra(piece, grid_.types.size() - count, first);
    return true;
  }

  // Replaces the corners of a piece's polyhedra by their faces. The cells of the piece begin at `first_cell`.
  void read_polyhedra(std::size_t piece, std::size_t first_cell, std::size_t first_point) {
    PolyhedronArrays arrays;
    const std::size_t count = grid_.types.size() - first_cell;
    const auto read = [&](std::string_view name, std::size_t most) -> std::optional<std::vector<std::int32_t>> {
      const VtkArray* const array = array_of(piece, VtkSection::cells, name);
      if (!array) {
        builder_.fail("polyhedra without '" + std::string(name) + "'");
        return std::nullopt;
      }
      const auto values = numbers(*array, most);
      if (!values) return std::nullopt;
      builder_.draw(most * sizeof(std::int32_t));
      std::vector<std::int32_t> indices;
      indices.reserve(most);
      each_number(*values, most, [&](double value) {
        indices.push_back(value >= 0 && value < static_cast<double>(kBadIndex) ? static_cast<std::int32_t>(value)
                                                                               : kBadIndex);
      });
      return indices;
    };
    // Before VTK 9.4, one array holds the faces of all cells. From 9.4 on, cells refer to faces by number.
    arrays.numbered = array_of(piece, VtkSection::cells, "polyhedron_offsets") != nullptr;
    const auto take = [&](std::string_view name, std::size_t most, std::vector<std::int32_t>& to) {
      auto found = read(name, most);
      if (found) to = std::move(*found);
      return found.has_value();
    };
    const bool whole = arrays.numbered ? take("polyhedron_offsets", count, arrays.ends) &&
                                             take("polyhedron_to_faces", greatest_index(arrays.ends), arrays.faces) &&
                                             take("face_offsets", faces_below(arrays.faces), arrays.face_ends) &&
                                             take("face_connectivity", greatest_index(arrays.face_ends), arrays.corners)
                                       : take("faceoffsets", count, arrays.ends) &&
                                             take("faces", greatest_index(arrays.ends), arrays.faces);
    if (!whole) arrays = {};
    place_polyhedra(arrays, first_cell, first_point, data_.points.size() - first_point, grid_, builder_);
  }

  // Reads the cells of a section. Returns false if some are missing.
  bool read_cells(std::size_t piece, VtkSection section, std::uint64_t count, std::size_t first, PolyCells& cells) {
    if (count == 0) return true;
    const VtkArray* const ends = array_of(piece, section, "offsets");
    const VtkArray* const corners = array_of(piece, section, "connectivity");
    if (!ends || !corners || count > kMaxPolyPoints) {
      builder_.fail("cells without 'connectivity' and 'offsets'");
      return false;
    }
    const auto end_values = numbers(*ends, count);
    if (!end_values) return false;
    builder_.draw(count * sizeof(std::size_t));
    const std::size_t before = cells.corners.size();
    std::uint64_t last = 0;
    bool rising = true;
    std::vector<std::size_t> read;
    each_number(*end_values, count, [&](double end) {
      rising = rising && end >= static_cast<double>(last) && end < static_cast<double>(kMaxPolyPoints);
      if (!rising) return;
      last = static_cast<std::uint64_t>(end);
      read.push_back(before + static_cast<std::size_t>(last));
    });
    if (!rising) {
      builder_.fail("the offsets of cells are missing or not ascending");
      return false;
    }
    const auto corner_values = numbers(*corners, last);
    if (!corner_values) return false;
    builder_.draw(last * sizeof(std::int32_t));
    each_number(*corner_values, last, [&](double corner) {
      const bool good = corner >= 0 && corner < static_cast<double>(data_.points.size() - first);
      cells.corners.push_back(good ? static_cast<std::int32_t>(first + static_cast<std::size_t>(corner)) : kBadIndex);
    });
    cells.ends.insert(cells.ends.end(), read.begin(), read.end());
    return true;
  }

  SharedBytes file_;
  const VtkXmlHeader& header_;
  MeshBuilder& builder_;
  const VtkArray* shown_of_points_ = nullptr;
  const VtkArray* shown_of_cells_ = nullptr;
  PolyData data_;
  GridCells grid_;
};

/// Imports all pieces of a VTK XML PolyData file: vertices, lines, polygons and strips; or the visible cell faces of an
/// UnstructuredGrid (grid_cells.h). Data may be text, base64 or appended, with or without zlib. The active scalars
/// become colours (poly_data.h); else the first one-component point array; else those of cells. Vectors count by
/// length; bytes in threes and fours are colours. Active normals are kept. If an array of a piece is invalid or
/// missing, the rest is shown with an error. Layout:
/// https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
void import_vtk_surface(std::span<const std::byte> bytes, std::string_view type, MeshBuilder& builder) {
  const auto header = read_vtk_xml(bytes, type);
  if (const auto* problem = std::get_if<std::string>(&header)) return builder.fail(*problem);
  VtpImporter(bytes, std::get<VtkXmlHeader>(header), builder).run();
}

bool is_vtp(std::span<const std::byte> bytes) { return is_vtk_xml(bytes, "PolyData"); }
void import_vtp(std::span<const std::byte> bytes, MeshBuilder& builder) {
  import_vtk_surface(bytes, "PolyData", builder);
}

bool is_vtu(std::span<const std::byte> bytes) { return is_vtk_xml(bytes, "UnstructuredGrid"); }
void import_vtu(std::span<const std::byte> bytes, MeshBuilder& builder) {
  import_vtk_surface(bytes, "UnstructuredGrid", builder);
}

}  // namespace

extern constinit const ContentType kVtpFormat =
    mesh_type("VTK PolyData", "application/x-vtk-poly-data", ".vtp ", is_vtp, read_mesh<import_vtp>);

extern constinit const ContentType kVtuFormat =
    mesh_type("VTK UnstructuredGrid", "application/x-vtk-unstructured-grid", ".vtu ", is_vtu, read_mesh<import_vtu>);

}  // namespace gs::app
