#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/datasets/conventions/mesh_arrays.h"
#include "app/formats/datasets/conventions/vtkhdf_amr.h"
#include "app/formats/datasets/conventions/vtkhdf_grid.h"
#include "app/formats/vtk/grid_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

// VTKHDF: https://docs.vtk.org/en/latest/vtk_file_formats/vtkhdf_file_format/index.html

namespace gs::app {
namespace {

constexpr std::string_view kAmrType = "OverlappingAMR";

/// Reads the mesh of a step.
class VtkhdfMesh {
 public:
  VtkhdfMesh(DatasetTree& tree, std::string shown, const VoxelComponent& choice, MeshBuilder& builder)
      : tree_(tree), shown_(std::move(shown)), choice_(choice), builder_(builder), step_(tree) {}

  void run() {
    const bool grid = vtkhdf_type(tree_) == "UnstructuredGrid";
    choose_step();
    const std::vector<double> points = counts("/VTKHDF/NumberOfPoints");
    double point = step_.offset("PointOffsets", 0);
    std::array<Progress, PolyData::kKinds> progress{};
    static constexpr const char* kFolders[] = {"/VTKHDF/Vertices", "/VTKHDF/Lines", "/VTKHDF/Polygons",
                                               "/VTKHDF/Strips"};
    for (std::size_t kind = 0; kind < progress.size(); ++kind) {
      Progress& one = progress[kind];
      one.folder = grid ? kVtkhdfRoot : kFolders[kind];
      one.cells = counts(one.folder + "/NumberOfCells");
      one.ids = counts(one.folder + "/NumberOfConnectivityIds");
      one.cell = step_.offset("CellOffsets", grid ? 0 : kind);
      one.id = step_.offset("ConnectivityIdOffsets", grid ? 0 : kind);
    }
    const bool of_points = is_in_folder(shown_, kVtkhdfPointData), of_cells = is_in_folder(shown_, kVtkhdfCellData);
    double cell_data = 0;
    for (const Progress& one : progress) cell_data += grid && &one != progress.data() ? 0 : one.cell;
    const std::string data_offsets = of_points ? "PointDataOffsets/" : "CellDataOffsets/";
    double data_row = step_.offset(data_offsets + name_of_path(shown_), 0, of_points ? point : cell_data);
    double ghost_point = step_.offset("PointDataOffsets/" + std::string(kGhostArray), 0, point);
    double ghost_cell = step_.offset("CellDataOffsets/" + std::string(kGhostArray), 0, cell_data);
    for (std::size_t part = 0; part < points.size() && !failed_; ++part) {
      const std::size_t first_point = data_.points.size();
      if (!add_points(point, points[part])) return;
      double cells = 0;
      for (std::size_t kind = 0; kind < (grid ? 1 : progress.size()); ++kind) {
        cells += part < progress[kind].cells.size() ? progress[kind].cells[part] : 0;
        if (!add_cells(progress[kind], part, first_point, points[part], grid ? grid_.cells : data_.cells[kind], grid))
          return;
      }
      add_flags(kVtkhdfPointData, ghost_point, points[part], ghost_points_);
      add_flags(kVtkhdfCellData, ghost_cell, cells, ghost_cells_);
      ghost_point += points[part];
      ghost_cell += cells;
      if (of_points || of_cells) {
        const double rows = of_points ? points[part] : cells;
        add_data(data_row, rows, of_points ? data_.of_points : data_.of_cells);
        data_row += rows;
      }
      point += points[part];
    }
    if (failed_) return;
    if (data_.points.empty()) return builder_.warn("no points in the file");
    if (of_cells && !grid && points.size() > 1) {
      // With several parts, the order of cells differs from the order of their data.
      data_.of_cells = {};
      builder_.note("data of cells in several parts are not shown");
    }
    if (grid) {
      hide_cells(ghost_cells_, ghost_points_, grid_);
      add_grid(grid_, data_, builder_);
    } else if (points.size() == 1) {
      remove_hidden_cells(ghost_cells_, ghost_points_, data_);
    }
    build_poly_data(std::move(data_), builder_);
  }

 private:
  /// Cells of one kind: numbers of all parts of the step, and the next place in the arrays.
  struct Progress {
    std::string folder;
    std::vector<double> cells, ids;
    double cell = 0, id = 0;
    std::size_t read = 0;  // parts
  };

  void choose_step() {
    if (auto wrong = step_.choose(choice_)) {
      builder_.fail(std::move(*wrong));
      failed_ = true;
      return;
    }
    if (step_.steps() == 0) return;
    if (step_.times().size() == step_.steps())
      builder_.set_steps({step_.times(), static_cast<std::size_t>(step_.step())});
    if (step_.steps() > 1 && !choice_.step)
      builder_.note("step 0 of " + std::to_string(step_.steps()) + " is shown (--time chooses another)");
  }

  /// Returns the numbers of the parts of the step.
  std::vector<double> counts(const std::string& path) {
    const ArrayInfo* const array = tree_.find(path);
    if (!array || array->shape.empty() || failed_) return {};
    const auto [first, count] = step_.parts_of_step(*array);
    auto read = numbers(path, static_cast<double>(first), static_cast<double>(count));
    return read ? std::move(*read) : std::vector<double>();
  }

  std::optional<std::vector<double>> numbers(const std::string& path, double first, double count) {
    builder_.draw(0);
    if (!(first >= 0 && count >= 0 && first < 1e15 && count < 1e12)) return problem(path + ": a count is impossible");
    auto read = tree_.rows(path, static_cast<std::uint64_t>(first), static_cast<std::uint64_t>(count));
    if (auto* const text = std::get_if<std::string>(&read)) return problem(std::move(*text));
    return std::move(std::get<std::vector<double>>(read));
  }
  std::nullopt_t problem(std::string text) {
    builder_.fail(std::move(text));
    failed_ = true;
    return std::nullopt;
  }

  bool add_points(double first, double count) {
    if (count == 0) return true;
    const auto read = numbers("/VTKHDF/Points", first, count);
    if (!read) return false;
    builder_.draw(static_cast<std::uint64_t>(count) * sizeof(glm::vec3));
    append_points(*read, 3, data_.points);
    return true;
  }

  bool add_cells(Progress& from, std::size_t part, std::size_t first_point, double points, PolyCells& to, bool grid) {
    if (part >= from.cells.size() || part >= from.ids.size()) return true;
    const double count = from.cells[part], ids = from.ids[part];
    const auto advance = [&] {
      from.cell += count;
      from.id += ids;
      ++from.read;
    };
    if (count == 0) return advance(), true;
    // Each part has one more offset than cells. Some writers count those of earlier steps, too.
    std::optional<std::vector<double>> offsets;
    for (const double more : {0.0, step_.part()}) {
      const ArrayInfo* const array = tree_.find(from.folder + "/Offsets");
      const double first = from.cell + static_cast<double>(from.read) + more;
      if (!array || array->shape.empty() || first + count + 1 > static_cast<double>(array->shape[0])) continue;
      offsets = numbers(from.folder + "/Offsets", first, count + 1);
      if (!offsets) return false;
      if (offsets->front() == 0 && offsets->back() == ids) break;
    }
    if (!offsets) return problem(from.folder + "/Offsets has too few numbers"), false;
    const auto corners = numbers(from.folder + "/Connectivity", from.id, ids);
    if (!corners) return false;
    builder_.draw(corners->size() * sizeof(std::int32_t) + offsets->size() * sizeof(std::size_t));
    const std::size_t begin = to.corners.size();
    for (const double corner : *corners) {
      const std::int32_t index = index_below(corner, static_cast<std::size_t>(points));
      to.corners.push_back(index == kBadIndex ? index : index + static_cast<std::int32_t>(first_point));
    }
    std::size_t last = begin;
    for (std::size_t i = 1; i < offsets->size(); ++i) {
      const double end = (*offsets)[i];
      const bool good = end >= 0 && end <= ids && begin + static_cast<std::size_t>(end) >= last;
      last = good ? begin + static_cast<std::size_t>(end) : last;
      to.ends.push_back(last);
    }
    if (grid) {
      const auto types = numbers("/VTKHDF/Types", from.cell, count);
      if (!types) return false;
      for (const double type : *types)
        grid_.types.push_back(type >= 0 && type < 256 && type != kGridPolyhedron ? static_cast<std::uint8_t>(type)
                                                                                 : std::uint8_t{255});
    }
    advance();
    return true;
  }

  void add_data(double first, double rows, PolyData::Data& data) {
    const ArrayInfo* const array = tree_.find(shown_);
    if (!array || rows == 0) return;
    const std::size_t parts = parts_of_array(*array, 1);
    const auto read = numbers(shown_, first, rows);
    if (!read) return;
    builder_.draw(static_cast<std::uint64_t>(rows) * sizeof(float));
    if (data.title.empty()) set_title(name_of_path(shown_), parts, tree_.text(shown_, "units"), choice_, data);
    append_values(*read, parts, choice_, data);
  }

  /// Reads the flags of hidden points or cells, if the file has them.
  void add_flags(std::string_view folder, double first, double rows, GhostFlags& flags) {
    const std::string path = std::string(folder) + '/' + std::string(kGhostArray);
    const ArrayInfo* const array = tree_.find(path);
    if (!array || array->shape.size() != 1 || rows == 0 || failed_) return;
    const auto read = numbers(path, first, rows);
    if (!read) return;
    builder_.draw(read->size());
    for (const double flag : *read)
      flags.push_back(flag > 0 && flag < 256 ? static_cast<std::uint8_t>(flag) : std::uint8_t{0});
  }

  DatasetTree& tree_;
  std::string shown_;
  const VoxelComponent& choice_;
  MeshBuilder& builder_;
  VtkhdfStep step_;
  PolyData data_;
  GridCells grid_;
  GhostFlags ghost_points_, ghost_cells_;
  bool failed_ = false;
};

}  // namespace

bool suits_vtkhdf(DatasetTree& tree) { return tree.has_group(kVtkhdfRoot) && !vtkhdf_type(tree).empty(); }

std::vector<DatasetEntry> list_vtkhdf(DatasetTree& tree) {
  const std::string type = vtkhdf_type(tree);
  if (type == kAmrType) return list_vtkhdf_amr(tree);
  const bool image = type == "ImageData", mesh = type == "PolyData" || type == "UnstructuredGrid";
  std::vector<DatasetEntry> all;
  for (const ArrayInfo& array : tree.arrays()) {
    DatasetEntry entry = entry_of(tree, array);
    const bool of_points = is_in_folder(array.path, kVtkhdfPointData),
               of_cells = is_in_folder(array.path, kVtkhdfCellData);
    if (is_readable(array) && (of_points || of_cells) &&
        (image ? array.shape.size() >= 2 : mesh && !array.shape.empty())) {
      entry.form = image ? DatasetForm::volume : DatasetForm::mesh;
      entry.note = of_points ? "data of points" : "data of cells";
      const bool active =
          tree.text(std::string(of_points ? kVtkhdfPointData : kVtkhdfCellData), "Scalars") == name_of_path(array.path);
      entry.is_minor = is_bookkeeping(array.path);
      entry.rank = is_bookkeeping(array.path) ? 1 : (of_points ? 20 : 10) + (active ? 5 : 0);
      if (!image && parts_of_array(array, 1) == 1) entry.rank += 2;
    } else if (mesh && array.path == "/VTKHDF/Points" && is_readable(array)) {
      entry.form = DatasetForm::mesh;
      entry.note = "the mesh without data";
      entry.is_minor = true;
      entry.rank = 2;
    } else if (!image && !mesh && (of_points || of_cells)) {
      entry.note = "VTKHDF of the type " + type.substr(0, 40) +
                   " is not shown; expected ImageData, OverlappingAMR, PolyData or UnstructuredGrid";
    }
    all.push_back(std::move(entry));
  }
  return all;
}

VolumeResult vtkhdf_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) {
  if (vtkhdf_type(tree) == kAmrType) return vtkhdf_amr_volume(tree, entry, choice);
  const ArrayInfo* const array = tree.find(entry.path);
  if (!array) return std::string("there is no such array");
  GridSpec spec;
  spec.arrays = {*tree.index_of(entry.path)};
  spec.path = entry.path;
  spec.axes.resize(array->shape.size());
  read_common_attributes(tree, *array, spec);
  for (GridAxis& axis : spec.axes) axis = {};
  std::vector<double> extent = tree.numbers(kVtkhdfRoot, "WholeExtent"), origin = tree.numbers(kVtkhdfRoot, "Origin");
  std::vector<double> spacing = tree.numbers(kVtkhdfRoot, "Spacing"),
                      direction = tree.numbers(kVtkhdfRoot, "Direction");
  if (extent.size() != 6) extent = {0, 0, 0, 0, 0, 0};
  if (origin.size() != 3) origin = {0, 0, 0};
  if (spacing.size() != 3) spacing = {1, 1, 1};
  if (direction.size() != 9) direction = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const bool of_points = is_in_folder(entry.path, kVtkhdfPointData);
  const std::vector<double> times = vtkhdf_times(tree);
  const bool series = times.size() > 0 && array->shape.size() >= 4 && array->shape[0] == times.size();
  std::size_t axis = 0;
  if (series) {
    spec.axes[0].role = AxisRole::time;
    spec.axes[0].positions = times;
    axis = 1;
  }
  // Axes of one point may be left out.
  const std::size_t left = array->shape.size() - axis;
  std::size_t wide = 0;
  for (std::size_t i = 0; i < 3; ++i) wide += extent[2 * i + 1] > extent[2 * i] ? 1 : 0;
  const std::size_t space = std::min<std::size_t>(left >= 3 ? 3 : std::max<std::size_t>(wide, 2), left);
  for (std::size_t i = 0; i < space; ++i) spec.axes[axis + i].role = static_cast<AxisRole>(space - 1 - i);
  if (left == space + 1) spec.axes.back().role = AxisRole::component;
  glm::dmat3 turn;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      turn[column][row] = direction[static_cast<std::size_t>(row * 3 + column)];
  spec.directions = turn;
  // GridAxis::first counts along the directions, so the origin is turned back.
  const glm::dmat3 back = std::abs(glm::determinant(turn)) > 1e-9 ? glm::inverse(turn) : glm::dmat3(1);
  const glm::dvec3 base = back * glm::dvec3(origin[0], origin[1], origin[2]);
  for (GridAxis& one : spec.axes) {
    if (one.role > AxisRole::z) continue;
    const auto i = static_cast<std::size_t>(one.role);
    one.step = spacing[i];
    one.first = base[static_cast<int>(i)] + spacing[i] * (extent[2 * i] + (of_points ? 0 : 0.5));
  }
  const std::string name = lower_case(name_of_path(entry.path));
  spec.colors = name.find("rgb") != std::string::npos || name.find("color") != std::string::npos ||
                name.find("colour") != std::string::npos;
  return open_grid(tree, std::move(spec), choice);
}

void vtkhdf_mesh(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder) {
  VtkhdfMesh(tree, entry.path, choice, builder).run();
}

}  // namespace gs::app
