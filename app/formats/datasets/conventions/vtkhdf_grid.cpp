#include "app/formats/datasets/conventions/vtkhdf_grid.h"

#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/datasets/conventions/mesh_arrays.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr double kMostVtkhdfRows = 1e15;  // exact in a double
// Maximum number of parts that are read in parts. Each takes about 1 KB, and two small reads of the file.
constexpr std::size_t kMostVtkhdfParts = std::size_t{1} << 17;

/// Finder of the rows of the parts of an unstructured grid.
class VtkhdfRows {
 public:
  VtkhdfRows(DatasetTree& tree, std::string shown, const VoxelComponent& choice)
      : tree_(tree), shown_(std::move(shown)), choice_(choice), step_(tree) {}

  std::optional<GridRows> rows() {
    if (step_.choose(choice_)) return std::nullopt;
    const auto points = counts("/VTKHDF/NumberOfPoints"), cells = counts("/VTKHDF/NumberOfCells"),
               ids = counts("/VTKHDF/NumberOfConnectivityIds");
    if (points.empty() || points.size() > kMostVtkhdfParts || cells.size() != points.size() ||
        ids.size() != points.size())
      return std::nullopt;
    const bool of_points = is_in_folder(shown_, kVtkhdfPointData), of_cells = is_in_folder(shown_, kVtkhdfCellData);
    const double first_point = step_.offset("PointOffsets", 0), first_cell = step_.offset("CellOffsets", 0);
    double id = step_.offset("ConnectivityIdOffsets", 0), point = first_point, cell = first_cell;
    const double data = step_.offset((of_points ? "PointDataOffsets/" : "CellDataOffsets/") + name_of_path(shown_), 0,
                                     of_points ? point : cell);
    const double hidden_point = step_.offset("PointDataOffsets/" + std::string(kGhostArray), 0, point),
                 hidden_cell = step_.offset("CellDataOffsets/" + std::string(kGhostArray), 0, cell);
    GridRows grid;
    grid.of_points = of_points;
    grid.has_values = of_points || of_cells;
    const ArrayInfo* const values = grid.has_values ? tree_.find(shown_) : nullptr;
    const std::size_t width = values ? parts_of_array(*values, 1) : 1;
    for (std::size_t i = 0; i < points.size(); ++i) {
      GridPartRows part;
      part.space = static_cast<std::uint32_t>(i);
      part.points = static_cast<std::uint64_t>(points[i]);
      part.cells = static_cast<std::uint64_t>(cells[i]);
      part.places = {{"/VTKHDF/Points", {}, row(point), part.points, 3}};
      if (part.cells > 0 && part.points > 0) {
        const auto ends = ends_of(cell + static_cast<double>(i), cells[i], ids[i]);
        if (!ends) return std::nullopt;
        part.ends = *ends;
        part.types = {"/VTKHDF/Types", {}, row(cell), part.cells};
        part.corners = {"/VTKHDF/Connectivity", {}, row(id), static_cast<std::uint64_t>(ids[i])};
        const double before = of_points ? point - first_point : cell - first_cell;
        if (values) part.values = {shown_, {}, row(data + before), of_points ? part.points : part.cells, width};
        part.hidden_points = flags(kVtkhdfPointData, hidden_point + point - first_point, part.points);
        part.hidden_cells = flags(kVtkhdfCellData, hidden_cell + cell - first_cell, part.cells);
        grid.parts.push_back(std::move(part));
      }
      point += points[i];
      cell += cells[i];
      id += ids[i];
    }
    if (point > kMostVtkhdfRows || cell > kMostVtkhdfRows || id > kMostVtkhdfRows) return std::nullopt;
    if (values) {
      PolyData::Data title;
      set_title(name_of_path(shown_), width, tree_.text(shown_, "units"), choice_, title);
      grid.title = title.title;
    }
    return grid;
  }

 private:
  static std::uint64_t row(double number) {
    return static_cast<std::uint64_t>(std::clamp(number, 0.0, kMostVtkhdfRows));
  }

  std::vector<double> counts(const std::string& path) {
    const ArrayInfo* const array = tree_.find(path);
    if (!array || array->shape.empty()) return {};
    const auto [first, count] = step_.parts_of_step(*array);
    auto read = tree_.rows(path, first, count);
    auto* const numbers = std::get_if<std::vector<double>>(&read);
    const auto possible = [](double number) { return number >= 0 && number <= kMostVtkhdfRows; };
    return numbers && std::ranges::all_of(*numbers, possible) ? std::move(*numbers) : std::vector<double>();
  }

  /// Returns the ends of a part's cells: its offsets after the first one, which is 0. Returns nullopt on failure.
  std::optional<ArrayRows> ends_of(double first, double cells, double ids) {
    const char* const path = "/VTKHDF/Offsets";
    const ArrayInfo* const array = tree_.find(path);
    if (!array || array->shape.empty()) return std::nullopt;
    // Some writers also count the additional offset of each part of earlier steps.
    for (const double more : {0.0, step_.part()}) {
      if (first + more + cells + 1 > static_cast<double>(array->shape[0])) continue;
      const auto begin = number_at(path, row(first + more)), end = number_at(path, row(first + more + cells));
      if (begin == 0.0 && end == ids) return ArrayRows{path, {}, row(first + more) + 1, row(cells)};
    }
    return std::nullopt;
  }
  std::optional<double> number_at(const std::string& path, std::uint64_t at) {
    const auto read = tree_.rows(path, at, 1);
    const auto* const numbers = std::get_if<std::vector<double>>(&read);
    return numbers && numbers->size() == 1 ? std::optional(numbers->front()) : std::nullopt;
  }
  ArrayRows flags(std::string_view folder, double first, std::uint64_t rows) {
    const std::string path = std::string(folder) + '/' + std::string(kGhostArray);
    const ArrayInfo* const array = tree_.find(path);
    return array && array->shape.size() == 1 ? ArrayRows{path, {}, row(first), rows} : ArrayRows();
  }

  DatasetTree& tree_;
  std::string shown_;
  const VoxelComponent& choice_;
  VtkhdfStep step_;
};

}  // namespace

std::string vtkhdf_type(DatasetTree& tree) {
  const std::string stated = tree.text(kVtkhdfRoot, "Type");
  if (!stated.empty()) return stated;
  // Early files have no type.
  return tree.find("/VTKHDF/Types")                   ? "UnstructuredGrid"
         : tree.attribute(kVtkhdfRoot, "WholeExtent") ? "ImageData"
                                                      : "";
}

bool is_in_folder(const std::string& path, std::string_view folder) {
  return path.size() > folder.size() + 1 && path.starts_with(folder) && path[folder.size()] == '/' &&
         path.find('/', folder.size() + 1) == std::string::npos;
}

std::size_t parts_of_array(const ArrayInfo& array, std::size_t axes) {
  std::size_t parts = array.parts;
  for (std::size_t i = axes; i < array.shape.size(); ++i) parts *= static_cast<std::size_t>(array.shape[i]);
  return parts;
}

std::vector<double> vtkhdf_times(DatasetTree& tree) {
  auto read = tree.find("/VTKHDF/Steps/Values") ? tree.values("/VTKHDF/Steps/Values")
                                                : std::variant<std::vector<double>, std::string>();
  auto* const times = std::get_if<std::vector<double>>(&read);
  return times ? std::move(*times) : std::vector<double>();
}

std::optional<std::string> VtkhdfStep::choose(const VoxelComponent& choice) {
  times_ = vtkhdf_times(tree_);
  if (choice.found) choice.found->times = times_;
  const double stated = tree_.number("/VTKHDF/Steps", "NSteps").value_or(0);
  steps_ = stated >= 1 && stated < 1e9 ? static_cast<std::uint64_t>(stated) : times_.size();
  if (steps_ == 0) return std::nullopt;
  const qnv::ShownStep wanted = choice.step.value_or(qnv::ShownStep());
  step_ = wanted.time && !times_.empty() ? qnv::step_number(wanted, times_) : wanted.number;
  if (step_ >= steps_) return "no step " + std::to_string(step_) + "; expected 0 to " + std::to_string(steps_ - 1);
  part_ = offset("PartOffsets", 0);
  parts_ = static_cast<std::uint64_t>(std::max(offset("NumberOfParts", 0, 1), 0.0));
  return std::nullopt;
}

double VtkhdfStep::offset(const std::string& name, std::size_t column, double otherwise) {
  const std::string path = "/VTKHDF/Steps/" + name;
  if (steps_ == 0 || !tree_.find(path)) return otherwise;
  auto read = tree_.rows(path, step_, 1);
  const auto* const row = std::get_if<std::vector<double>>(&read);
  if (!row || row->empty()) return otherwise;
  const double found = (*row)[std::min(column, row->size() - 1)];
  return found >= 0 && found < kMostVtkhdfRows ? found : otherwise;
}

std::pair<std::uint64_t, std::uint64_t> VtkhdfStep::parts_of_step(const ArrayInfo& array) const {
  return steps_ > 0 ? std::pair(static_cast<std::uint64_t>(part_), parts_)
                    : std::pair(std::uint64_t{0}, array.shape[0]);
}

std::optional<GridRows> vtkhdf_grid(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) {
  if (vtkhdf_type(tree) != "UnstructuredGrid") return std::nullopt;
  return VtkhdfRows(tree, entry.path, choice).rows();
}

}  // namespace gs::app
