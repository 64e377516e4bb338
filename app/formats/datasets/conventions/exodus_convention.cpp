#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/datasets/conventions/mesh_arrays.h"
#include "app/formats/vtk/grid_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

// Exodus II: meshes of finite elements in NetCDF files. https://sandialabs.github.io/seacas-docs

namespace gs::app {
namespace {

constexpr std::size_t kMostBlocks = 10'000;

struct ExodusElement {
  std::string_view name;  // upper case, without the number of nodes
  std::uint8_t vtk;       // vtkCellType.h
  std::size_t corners;
};
constexpr ExodusElement kExodusElements[] = {{"HEX", 12, 8},  {"TET", 10, 4},  {"WEDGE", 13, 6}, {"PYRAMID", 14, 5},
                                             {"TRI", 5, 3},   {"QUAD", 9, 4},  {"SHELL", 9, 4},  {"BAR", 3, 2},
                                             {"BEAM", 3, 2},  {"TRUSS", 3, 2}, {"EDGE", 3, 2},   {"SPHERE", 1, 1},
                                             {"CIRCLE", 1, 1}};

/// Variable with values at nodes or in elements.
struct ExodusVariable {
  std::string name;
  std::size_t number = 0;  // from 1
  bool of_nodes = false;
};

std::string numbered(std::string_view name, std::size_t number) { return std::string(name) + std::to_string(number); }

std::vector<ExodusVariable> variables_of(DatasetTree& tree) {
  std::vector<ExodusVariable> all;
  for (const bool of_nodes : {true, false}) {
    const auto place = tree.index_of(of_nodes ? "/name_nod_var" : "/name_elem_var");
    if (!place) continue;
    std::size_t number = 0;
    for (const std::string& name : tree.file()->texts(*place))
      all.push_back({name.empty() ? numbered(of_nodes ? "node" : "element", number + 1) : name, ++number, of_nodes});
  }
  return all;
}

/// Returns the element type of a block. Returns null for unsupported types.
const ExodusElement* block_element(DatasetTree& tree, const ArrayInfo& connections) {
  std::string kind = tree.text(connections.path, "elem_type");
  for (char& c : kind) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c;
  const auto* const element =
      std::ranges::find_if(kExodusElements, [&](const ExodusElement& one) { return kind.starts_with(one.name); });
  const auto& shape = connections.shape;
  return element != std::end(kExodusElements) && shape.size() == 2 && shape[1] >= element->corners ? element : nullptr;
}

/// Returns the path of the array of a variable: at nodes, or in an element block.
std::string variable_path(const DatasetTree& tree, const ExodusVariable& variable, std::size_t block) {
  const std::string separate = variable.of_nodes ? numbered("/vals_nod_var", variable.number)
                                                 : numbered(numbered("/vals_elem_var", variable.number) + "eb", block);
  return tree.find(separate) || !variable.of_nodes ? separate : "/vals_nod_var";
}

std::optional<ExodusVariable> variable_of(DatasetTree& tree, const DatasetEntry& entry) {
  for (ExodusVariable& one : variables_of(tree))
    if (entry.path == (one.of_nodes ? "/nodes/" : "/elements/") + one.name) return std::move(one);
  return std::nullopt;
}

/// Returns the rows of a variable in a step. Returns empty rows if the file lacks them.
ArrayRows variable_rows(const DatasetTree& tree, const ExodusVariable& variable, std::size_t block, std::uint64_t step,
                        std::uint64_t rows) {
  const std::string path = variable_path(tree, variable, block);
  const ArrayInfo* const array = tree.find(path);
  if (!array || array->shape.empty() || step >= array->shape[0]) return {};
  if (array->shape.size() == 2) return {path, {step}, 0, rows};
  return array->shape.size() == 3 && variable.number <= array->shape[1]
             ? ArrayRows{path, {step, variable.number - 1}, 0, rows}
             : ArrayRows();
}

/// Returns the rows of the coordinates, one entry per axis, from one array of all axes or an array per axis.
std::vector<ArrayRows> coordinate_rows(const DatasetTree& tree) {
  std::vector<ArrayRows> axes;
  if (const ArrayInfo* const all = tree.find("/coord")) {
    for (std::uint64_t i = 0; all->shape.size() == 2 && all->shape[0] <= 3 && i < all->shape[0]; ++i)
      axes.push_back({all->path, {i}, 0, all->shape[1]});
    return axes;
  }
  for (const char* const name : {"/coordx", "/coordy", "/coordz"})
    if (const ArrayInfo* const one = tree.find(name); one && one->shape.size() == 1)
      axes.push_back({name, {}, 0, one->shape[0]});
  return axes;
}

/// Reads the row of a step: of a variable at nodes, or of an element block.
std::optional<std::vector<double>> variable_row(DatasetTree& tree, const ExodusVariable& variable, std::size_t block,
                                                std::uint64_t step, MeshBuilder& builder) {
  const std::string path = variable_path(tree, variable, block);
  const ArrayInfo* const array = tree.find(path);
  if (!array || array->shape.empty() || step >= array->shape[0]) return std::nullopt;
  builder.draw(0);
  auto read = tree.rows(path, step, 1);
  if (const auto* const problem = std::get_if<std::string>(&read)) {
    builder.fail(*problem);
    return std::nullopt;
  }
  auto& row = std::get<std::vector<double>>(read);
  if (array->shape.size() != 3) return std::move(row);
  // Older files have all variables in one array.
  const auto nodes = static_cast<std::size_t>(array->shape[2]), first = (variable.number - 1) * nodes;
  if (first + nodes > row.size()) return std::nullopt;
  return std::vector<double>(row.begin() + static_cast<std::ptrdiff_t>(first),
                             row.begin() + static_cast<std::ptrdiff_t>(first + nodes));
}

/// Returns the times of the steps, and the number of the chosen step, which may not exist.
std::pair<std::vector<double>, std::size_t> exodus_step(DatasetTree& tree, const VoxelComponent& choice) {
  auto read = tree.find("/time_whole") ? tree.values("/time_whole") : std::variant<std::vector<double>, std::string>();
  auto* const times = std::get_if<std::vector<double>>(&read);
  std::vector<double> all = times ? std::move(*times) : std::vector<double>();
  const qnv::ShownStep wanted = choice.step.value_or(qnv::ShownStep());
  const std::size_t step = wanted.time && !all.empty() ? qnv::step_number(wanted, all) : wanted.number;
  return {std::move(all), step};
}

bool add_exodus_points(DatasetTree& tree, PolyData& data, MeshBuilder& builder) {
  std::vector<std::vector<double>> axes;
  if (tree.find("/coord")) {
    auto read = tree.values("/coord");
    const auto* const all = std::get_if<std::vector<double>>(&read);
    const auto& shape = tree.find("/coord")->shape;
    if (!all || shape.size() != 2 || shape[0] > 3) return false;
    const auto nodes = static_cast<std::ptrdiff_t>(shape[1]);
    for (std::uint64_t i = 0; i < shape[0]; ++i) {
      const auto first = all->begin() + nodes * static_cast<std::ptrdiff_t>(i);
      axes.emplace_back(first, first + nodes);
    }
  } else {
    for (const char* const name : {"/coordx", "/coordy", "/coordz"}) {
      if (!tree.find(name)) continue;
      auto read = tree.values(name);
      auto* const all = std::get_if<std::vector<double>>(&read);
      if (!all) return false;
      axes.push_back(std::move(*all));
    }
  }
  if (axes.empty()) return false;
  builder.draw(axes[0].size() * sizeof(glm::vec3));
  for (std::size_t i = 0; i < axes[0].size(); ++i) {
    glm::vec3 point(0);
    for (std::size_t k = 0; k < axes.size(); ++k)
      point[static_cast<int>(k)] = i < axes[k].size() ? static_cast<float>(axes[k][i]) : 0.0f;
    data.points.push_back(point);
  }
  return true;
}

}  // namespace

bool suits_exodus(DatasetTree& tree) {
  return tree.attribute("/", "api_version") && (tree.find("/coord") || tree.find("/coordx")) && tree.find("/connect1");
}

std::vector<DatasetEntry> list_exodus(DatasetTree& tree) {
  std::vector<DatasetEntry> all;
  for (const ExodusVariable& variable : variables_of(tree)) {
    DatasetEntry entry;
    const std::string path = variable.of_nodes ? numbered("/vals_nod_var", variable.number)
                                               : numbered("/vals_elem_var", variable.number) + "eb1";
    if (const ArrayInfo* const array = tree.find(path)) {
      entry = entry_of(tree, *array);
      entry.axes.clear();
    } else if (const ArrayInfo* const all_nodes = tree.find("/vals_nod_var");
               all_nodes && all_nodes->shape.size() == 3) {
      entry.type = all_nodes->type_name;
      entry.shape = {all_nodes->shape[0], all_nodes->shape[2]};
    }
    entry.path = (variable.of_nodes ? "/nodes/" : "/elements/") + variable.name;
    entry.form = DatasetForm::mesh;
    entry.note = variable.of_nodes ? "data of points" : "data of cells";
    entry.is_minor = is_bookkeeping(variable.name);
    entry.rank = entry.is_minor ? 1 : variable.of_nodes ? 20 : 10;
    all.push_back(std::move(entry));
  }
  DatasetEntry mesh;
  mesh.path = "/mesh";
  mesh.type = "mesh";
  if (const ArrayInfo* const points = tree.find("/coordx"); points && points->shape.size() == 1)
    mesh.shape = points->shape;
  mesh.form = DatasetForm::mesh;
  mesh.note = "the mesh without data";
  mesh.is_minor = !all.empty();
  mesh.rank = 0.5;
  all.push_back(std::move(mesh));
  for (const ArrayInfo& array : tree.arrays()) all.push_back(entry_of(tree, array));
  return all;
}

VolumeResult exodus_volume(DatasetTree&, const DatasetEntry& entry, const VoxelComponent&) {
  return entry.path + std::string(kIsMesh);
}

void exodus_mesh(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder) {
  const std::optional<ExodusVariable> shown = variable_of(tree, entry);
  const auto [times, step] = exodus_step(tree, choice);
  const std::size_t steps = times.size();
  if (choice.found && steps > 0) choice.found->times = times;
  if (step >= std::max<std::size_t>(steps, 1))
    return builder.fail("no step " + std::to_string(step) + "; expected 0 to " +
                        std::to_string(std::max<std::size_t>(steps, 1) - 1));
  if (steps > 1 && shown) builder.set_steps({times, step});
  if (steps > 1 && !choice.step && shown)
    builder.note("step 0 of " + std::to_string(steps) + " is shown (--time chooses another)");
  PolyData data;
  GridCells grid;
  if (!add_exodus_points(tree, data, builder)) return builder.fail("its coordinates cannot be read");
  std::size_t unknown = 0;
  for (std::size_t block = 1; block <= kMostBlocks; ++block) {
    const std::string path = numbered("/connect", block);
    const ArrayInfo* const array = tree.find(path);
    if (!array) break;
    const ExodusElement* const element = block_element(tree, *array);
    if (!element) {
      ++unknown;
      continue;
    }
    auto connections = tree.values(path);
    if (const auto* const problem = std::get_if<std::string>(&connections)) return builder.fail(*problem);
    const auto& ids = std::get<std::vector<double>>(connections);
    const auto nodes = static_cast<std::size_t>(array->shape[1]), count = static_cast<std::size_t>(array->shape[0]);
    builder.draw(count * (element->corners * sizeof(std::int32_t) + sizeof(std::size_t) + 1));
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < element->corners; ++k)
        grid.cells.corners.push_back(index_below(ids[i * nodes + k] - 1, data.points.size()));
      grid.cells.ends.push_back(grid.cells.corners.size());
      grid.types.push_back(element->vtk);
    }
    if (!shown || shown->of_nodes) continue;
    data.of_cells.values.resize(grid.types.size() - count, NAN);
    if (const auto values = variable_row(tree, *shown, block, step, builder))
      append_values(*values, 1, choice, data.of_cells);
    data.of_cells.values.resize(grid.types.size(), NAN);
  }
  if (unknown > 0) builder.warn(std::to_string(unknown) + " blocks of unsupported elements are left out");
  if (shown && shown->of_nodes)
    if (const auto values = variable_row(tree, *shown, 0, step, builder)) {
      append_values(*values, 1, choice, data.of_points);
      data.of_points.values.resize(data.points.size(), NAN);
    }
  if (shown) set_title(shown->name, 1, {}, choice, shown->of_nodes ? data.of_points : data.of_cells);
  if (std::ranges::all_of(data.of_cells.values, [](float value) { return std::isnan(value); })) data.of_cells = {};
  if (!grid.types.empty()) add_grid(grid, data, builder);
  build_poly_data(std::move(data), builder);
}

std::optional<GridRows> exodus_grid(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) {
  const std::optional<ExodusVariable> shown = variable_of(tree, entry);
  const auto [times, step] = exodus_step(tree, choice);
  const std::vector<ArrayRows> places = coordinate_rows(tree);
  if (step >= std::max<std::size_t>(times.size(), 1) || places.empty()) return std::nullopt;
  GridRows grid;
  for (std::size_t block = 1; block <= kMostBlocks; ++block) {
    const ArrayInfo* const array = tree.find(numbered("/connect", block));
    if (!array) break;
    const ExodusElement* const element = block_element(tree, *array);
    if (!element) return std::nullopt;
    if (array->shape[0] == 0) continue;
    GridPartRows part;
    part.points = places.front().rows;
    part.cells = array->shape[0];
    part.places = places;
    part.element = element->vtk;
    part.corners = {array->path, {}, 0, part.cells, element->corners, 1};
    const std::uint64_t rows = shown && shown->of_nodes ? part.points : part.cells;
    if (shown) part.values = variable_rows(tree, *shown, block, step, rows);
    // Leaves grids with a short array to the importer, which shows the values that exist.
    if (!part.values.empty() && tree.find(part.values.path)->shape.back() < rows) return std::nullopt;
    grid.has_values = grid.has_values || !part.values.empty();
    grid.parts.push_back(std::move(part));
  }
  if (shown && grid.has_values) {
    PolyData::Data title;
    set_title(shown->name, 1, {}, choice, title);
    grid.title = title.title;
    grid.of_points = shown->of_nodes;
  }
  return grid;
}

}  // namespace gs::app
