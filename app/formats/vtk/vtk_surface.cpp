#include "app/formats/vtk/vtk_surface.h"

#include "app/formats/vtk/polyhedra.h"
#include "app/formats/vtk/structured_faces.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

constexpr std::uint64_t kMaxPolyPoints = static_cast<std::uint64_t>(kBadIndex);
constexpr vrml::Color kWithoutData{0.5f, 0.5f, 0.5f};

bool is_structured(std::string_view type) {
  return type == "ImageData" || type == "RectilinearGrid" || type == "StructuredGrid";
}

// Fills up data that later pieces lack.
void fill_up(PolyData::Data& data, std::size_t count) {
  if (!data.colors.empty()) data.colors.resize(count, kWithoutData);
  if (!data.values.empty()) data.values.resize(count, NAN);
}

// Appends the part of `from` that begins at `first`, behind `before` rows.
void append_part(const PolyData::Data& from, std::size_t first, std::size_t count, std::size_t before,
                 PolyData::Data& to) {
  if (from.empty() || count == 0) return;
  if (to.title.empty()) to.title = from.title;
  if (!from.colors.empty()) {
    to.colors.resize(before, kWithoutData);
    for (std::size_t i = first; i < first + count; ++i)
      to.colors.push_back(i < from.colors.size() ? from.colors[i] : kWithoutData);
  } else {
    to.values.resize(before, NAN);
    for (std::size_t i = first; i < first + count; ++i)
      to.values.push_back(i < from.values.size() ? from.values[i] : NAN);
  }
}

void append_flags(const GhostFlags& from, std::size_t first, std::size_t count, std::size_t before, GhostFlags& to) {
  if (from.empty()) return;
  to.resize(before, 0);
  for (std::size_t i = first; i < first + count; ++i) to.push_back(i < from.size() ? from[i] : std::uint8_t{0});
}

}  // namespace

void VtkSurfaceReader::add(const SharedBytes& file, const VtkXmlHeader& header) {
  file_ = file;
  header_ = &header;
  if (header.piece_count > header.pieces.size())
    builder_.fail(std::to_string(header.piece_count) + " pieces; the first " + std::to_string(header.pieces.size()) +
                  " are read");
  for (std::size_t i = 0; i < header.pieces.size(); ++i)
    is_structured(header.type) ? add_structured_piece(i) : add_piece(i);
}

PolyData VtkSurfaceReader::take() {
  fill_up(data_.of_points, data_.points.size());
  if (data_.normals.size() != data_.points.size()) data_.normals.clear();
  if (grid_.types.empty()) {
    for (std::size_t kind = 0; kind < PolyData::kKinds; ++kind) {
      fill_up(of_kind_[kind], data_.cells[kind].ends.size());
      remove_hidden_cells(ghost_kinds_[kind], ghost_points_, data_.cells[kind], of_kind_[kind]);
    }
    join_cell_data();
  } else {
    fill_up(of_grid_, grid_.types.size());
    hide_cells(ghost_cells_, ghost_points_, grid_);
    data_.of_cells = std::move(of_grid_);
    add_grid(grid_, data_, builder_);
  }
  return std::move(data_);
}

void VtkSurfaceReader::join_cell_data() {
  std::size_t cells = 0;
  for (std::size_t kind = 0; kind < PolyData::kKinds; ++kind) {
    append_part(of_kind_[kind], 0, data_.cells[kind].ends.size(), cells, data_.of_cells);
    cells += data_.cells[kind].ends.size();
  }
  fill_up(data_.of_cells, cells);
}

const VtkArray* VtkSurfaceReader::array_of(std::size_t piece, VtkSection section, std::string_view name) const {
  for (const VtkArray& array : header_->arrays)
    if (array.piece == piece && array.section == section && (name.empty() || array.name == name)) return &array;
  return nullptr;
}

// Reads the first `count` numbers of an array. On failure, reports an error and returns nullopt.
std::optional<StoredVoxels> VtkSurfaceReader::numbers(const VtkArray& array, std::uint64_t count) {
  auto values = vtk_values(file_, *header_, array, count, builder_.budget());
  if (auto* found = std::get_if<StoredVoxels>(&values)) return std::move(*found);
  builder_.fail("the array '" + array.name.substr(0, 80) + "': " + std::get<std::string>(values));
  return std::nullopt;
}

void VtkSurfaceReader::add_piece(std::size_t number) {
  const VtkPiece& piece = header_->pieces[number];
  if (piece.points == 0) return;
  const std::size_t first = data_.points.size();
  if (piece.points > kMaxPolyPoints - first)
    return builder_.fail("a piece of " + std::to_string(piece.points) + " points; expected less than 2^31 in all");
  const VtkArray* const places = array_of(number, VtkSection::points, {});
  if (!places || places->components != 3) return builder_.fail("a piece has no Points with three components");
  if (!read_vectors(*places, piece.points, data_.points)) return;
  const std::string& name = header_->point_normals;
  const VtkArray* const normals = name.empty() ? nullptr : array_of(number, VtkSection::point_data, name);
  if (normals && normals->components == 3 && data_.normals.size() == first)
    (void)read_vectors(*normals, piece.points, data_.normals);
  if (shown_.section == VtkSection::point_data) read_data(number, first, piece.points, data_.of_points);
  append_flags(ghosts(number, VtkSection::point_data, piece.points), 0, piece.points, first, ghost_points_);
  const std::size_t first_cell = grid_.types.size();
  if (read_grid(number, piece.cells, first) && piece.cells > 0) {
    append_flags(ghosts(number, VtkSection::cell_data, piece.cells), 0, piece.cells, first_cell, ghost_cells_);
    if (shown_.section == VtkSection::cell_data) read_data(number, first_cell, piece.cells, of_grid_);
  }
  const std::pair<VtkSection, std::uint64_t> kinds[] = {{VtkSection::vertices, piece.vertices},
                                                        {VtkSection::lines, piece.lines},
                                                        {VtkSection::polygons, piece.polygons},
                                                        {VtkSection::strips, piece.strips}};
  std::uint64_t cells = 0;
  bool whole = true;
  std::array<std::size_t, PolyData::kKinds> before{};
  for (std::size_t kind = 0; kind < PolyData::kKinds; ++kind) {
    cells += kinds[kind].second;
    before[kind] = data_.cells[kind].ends.size();
    whole = read_cells(number, kinds[kind].first, kinds[kind].second, first, data_.cells[kind]) && whole;
  }
  if (whole && cells > 0) read_cell_data(number, cells, before);
}

void VtkSurfaceReader::read_cell_data(std::size_t piece, std::uint64_t count,
                                      const std::array<std::size_t, PolyData::kKinds>& before) {
  PolyData::Data data;
  if (shown_.section == VtkSection::cell_data) read_data(piece, 0, count, data);
  const GhostFlags flags = ghosts(piece, VtkSection::cell_data, count);
  std::size_t at = 0;
  for (std::size_t kind = 0; kind < PolyData::kKinds; ++kind) {
    const std::size_t cells = data_.cells[kind].ends.size() - before[kind];
    append_part(data, at, cells, before[kind], of_kind_[kind]);
    append_flags(flags, at, cells, before[kind], ghost_kinds_[kind]);
    at += cells;
  }
}

void VtkSurfaceReader::add_structured_piece(std::size_t number) {
  const VtkPiece& piece = header_->pieces[number];
  const auto extent = vtk_extent(piece.extent.empty() ? header_->whole_extent : piece.extent);
  if (!extent) return builder_.fail("the extent is '" + piece.extent.substr(0, 80) + "'; expected six whole numbers");
  StructuredBlock block;
  block.first = data_.points.size();
  for (std::size_t axis = 0; axis < 3; ++axis)
    block.points[axis] = static_cast<std::size_t>((*extent)[2 * axis + 1] - (*extent)[2 * axis] + 1);
  const double points = static_cast<double>(block.points[0]) * static_cast<double>(block.points[1]) *
                        static_cast<double>(block.points[2]);
  if (points > static_cast<double>(kMaxPolyPoints - block.first))
    return builder_.fail("a piece of " + std::to_string(points) + " points; expected less than 2^31 in all");
  if (!add_structured_points(number, *extent, block.point_count())) return data_.points.resize(block.first);
  if (shown_.section == VtkSection::point_data) read_data(number, block.first, block.point_count(), data_.of_points);
  PolyData::Data data;
  if (shown_.section == VtkSection::cell_data) read_data(number, 0, block.cell_count(), data);
  const std::size_t before = data_.cells[PolyData::polygons].ends.size();
  const std::vector<std::size_t> owners =
      add_structured_faces(block, ghosts(number, VtkSection::cell_data, block.cell_count()),
                           ghosts(number, VtkSection::point_data, block.point_count()), data_, builder_);
  if (data.empty()) return;
  PolyData::Data of_faces;
  of_faces.title = data.title;
  builder_.draw(owners.size() * (data.colors.empty() ? sizeof(float) : sizeof(vrml::Color)));
  for (const std::size_t cell : owners)
    data.colors.empty() ? of_faces.values.push_back(cell < data.values.size() ? data.values[cell] : NAN)
                        : of_faces.colors.push_back(cell < data.colors.size() ? data.colors[cell] : kWithoutData);
  append_part(of_faces, 0, owners.size(), before, of_kind_[PolyData::polygons]);
}

// Adds the points of a piece: those of the file, or by coordinates of the axes, or by origin and distances.
bool VtkSurfaceReader::add_structured_points(std::size_t number, const std::array<std::int64_t, 6>& extent,
                                             std::uint64_t count) {
  if (const VtkArray* const places = array_of(number, VtkSection::points, {}))
    return places->components == 3 && read_vectors(*places, count, data_.points);
  if (header_->type == "StructuredGrid") {
    builder_.fail("a piece has no Points with three components");
    return false;
  }
  const VtkGridAxes axes = vtk_grid_axes(file_, *header_, number, extent, builder_.budget());
  if (!axes.problem.empty()) {
    builder_.fail(axes.problem);
    return false;
  }
  builder_.draw(count * sizeof(glm::vec3));
  for (const double z : axes.positions[2])
    for (const double y : axes.positions[1])
      for (const double x : axes.positions[0])
        data_.points.emplace_back(axes.directions * glm::dvec3(x, y, z) + axes.origin);
  return true;
}

bool VtkSurfaceReader::read_vectors(const VtkArray& array, std::uint64_t count, std::vector<glm::vec3>& to) {
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

GhostFlags VtkSurfaceReader::ghosts(std::size_t piece, VtkSection section, std::uint64_t count) {
  const VtkArray* array = array_of(piece, section, kGhostArray);
  const bool old = !array;
  if (old) array = section == VtkSection::cell_data ? array_of(piece, section, kOldGhostArray) : nullptr;
  if (!array || array->components != 1 || count > kMaxPolyPoints) return {};
  const auto values = numbers(*array, count);
  if (!values) return {};
  builder_.draw(count);
  GhostFlags flags;
  bool hides = false;
  each_number(*values, count, [&](double value) {
    const auto stored = value > 0 && value < 256 ? static_cast<std::uint8_t>(value) : std::uint8_t{0};
    flags.push_back(old && stored > 0 ? std::uint8_t{1} : stored);
    hides = hides || stored != 0;
  });
  return hides ? flags : GhostFlags();
}

void VtkSurfaceReader::read_data(std::size_t piece, std::size_t first, std::uint64_t count, PolyData::Data& data) {
  const VtkArray* const array = shown_.name.empty() ? nullptr : array_of(piece, shown_.section, shown_.name);
  constexpr std::uint64_t kMaxComponents = 64;
  if (!array || array->components == 0 || array->components > kMaxComponents || count > kMaxPolyPoints) return;
  const auto values = numbers(*array, count * array->components);
  if (!values) return;
  const bool colors = array->type == "uint8" && (array->components == 3 || array->components == 4) && !choice_.chosen;
  if (choice_.found) choice_.found->components = array->components;
  builder_.draw(count * (colors ? sizeof(vrml::Color) : sizeof(float)));
  if (data.title.empty())
    data.title = array->name.substr(0, 80) + part_text(array->components, choice_) +
                 (array->units.empty() ? "" : " (" + array->units + ")");
  if (colors)
    data.colors.resize(first, kWithoutData);
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
      data.colors.push_back({share(0), share(1), share(2)});
      return;
    }
    append_number(std::span(parts).first(array->components), choice_, data);
  });
}

// Reads the cells of a grid and their types. Returns false if some are missing.
bool VtkSurfaceReader::read_grid(std::size_t piece, std::uint64_t count, std::size_t first) {
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
void VtkSurfaceReader::read_polyhedra(std::size_t piece, std::size_t first_cell, std::size_t first_point) {
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
bool VtkSurfaceReader::read_cells(std::size_t piece, VtkSection section, std::uint64_t count, std::size_t first,
                                  PolyCells& cells) {
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

}  // namespace gs::app
