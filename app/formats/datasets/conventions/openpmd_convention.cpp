#include "app/formats/datasets/conventions/conventions_table.h"
#include "app/formats/datasets/conventions/mesh_arrays.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

// openPMD: https://github.com/openPMD/openPMD-standard

namespace gs::app {
namespace {

/// Place of a path in a file of openPMD: "/data/1/meshes/E/x" is the part "meshes" of iteration 1, record E,
/// component x.
struct OpenPmdPlace {
  std::string iteration;  // "1"
  std::string part;       // "meshes" or "particles"
  std::vector<std::string> names;
};

std::string trimmed_slashes(std::string text) {
  while (text.starts_with('/')) text.erase(0, 1);
  while (text.ends_with('/')) text.pop_back();
  return text;
}

std::string part_name(DatasetTree& tree, bool particles) {
  const std::string stated = trimmed_slashes(tree.text("/", particles ? "particlesPath" : "meshesPath"));
  return stated.empty() ? (particles ? "particles" : "meshes") : stated;
}

std::optional<OpenPmdPlace> place_of(DatasetTree& tree, std::string_view path) {
  constexpr std::string_view kBase = "/data/";
  if (!path.starts_with(kBase)) return std::nullopt;
  std::vector<std::string> names;
  for (std::size_t at = kBase.size(); at <= path.size();) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    names.emplace_back(path.substr(at, end - at));
    at = end + 1;
  }
  if (names.size() < 3) return std::nullopt;
  OpenPmdPlace place{names[0], {}, {names.begin() + 2, names.end()}};
  if (names[1] == part_name(tree, false)) place.part = "meshes";
  if (names[1] == part_name(tree, true)) place.part = "particles";
  return place.part.empty() ? std::nullopt : std::optional(place);
}

double iteration_number(const std::string& name) {
  double number = 0;
  (void)std::from_chars(name.data(), name.data() + name.size(), number);
  return number;
}

/// Returns the iterations in ascending order.
std::vector<std::string> iterations(DatasetTree& tree) {
  std::vector<std::string> names;
  for (const std::string& group : tree.groups())
    if (folder_of_path(group) == "/data") names.push_back(name_of_path(group));
  std::ranges::stable_sort(names, {}, iteration_number);
  return names;
}

double iteration_time(DatasetTree& tree, const std::string& iteration) {
  const std::string path = "/data/" + iteration;
  const double unit = tree.number(path, "timeUnitSI").value_or(1);
  return tree.number(path, "time").value_or(iteration_number(iteration)) * unit;
}

/// Returns the unit of a record from the powers of the SI base units: "kg m^2 s^-3 A^-1".
std::string si_unit(std::span<const double> powers) {
  static constexpr const char* kBaseUnits[] = {"m", "kg", "s", "A", "K", "mol", "cd"};
  std::string text;
  for (std::size_t i = 0; i < std::min(powers.size(), std::size(kBaseUnits)); ++i) {
    if (powers[i] == 0) continue;
    text += (text.empty() ? "" : " ") + std::string(kBaseUnits[i]);
    if (powers[i] != 1) text += "^" + std::to_string(static_cast<int>(powers[i]));
  }
  return text;
}

/// Returns the arrays of a record: itself, or its components, in the order of their names.
std::vector<std::string> record_arrays(DatasetTree& tree, const std::string& path) {
  if (tree.find(path)) return {path};
  std::vector<std::string> all;
  for (const ArrayInfo& array : tree.arrays())
    if (folder_of_path(array.path) == path && is_readable(array)) all.push_back(array.path);
  return all;
}

std::string record_of(DatasetTree& tree, const std::string& path) {
  const auto place = place_of(tree, path);
  return place && place->names.size() > 1 ? folder_of_path(path) : path;
}

/// Returns the axes of a mesh. `theta` marks cylinders, of which the first axis has the modes of the angle.
std::vector<GridAxis> mesh_axes(DatasetTree& tree, const std::string& record, const ArrayInfo& array, bool theta) {
  const std::size_t rank = array.shape.size(), skipped = theta && rank > 0 ? 1 : 0;
  const ArrayAttribute* const labels = tree.attribute(record, "axisLabels");
  const std::vector<double> spacing = tree.numbers(record, "gridSpacing"),
                            offset = tree.numbers(record, "gridGlobalOffset");
  const std::vector<double> position = tree.numbers(array.path, "position");
  const double unit = tree.number(record, "gridUnitSI").value_or(1);
  const bool fortran = tree.text(record, "dataOrder") == "F";
  std::vector<GridAxis> axes(rank);
  for (std::size_t i = skipped; i < rank; ++i) {
    const std::size_t at = fortran ? rank - 1 - i : i - skipped;
    GridAxis& axis = axes[i];
    axis.role = rank - 1 - i < 3 ? static_cast<AxisRole>(rank - 1 - i) : AxisRole::channel;
    if (labels && at < labels->texts.size()) axis.name = labels->texts[at];
    const double step = at < spacing.size() ? spacing[at] : 1;
    axis.step = step * unit;
    axis.first = ((at < offset.size() ? offset[at] : 0) + (at < position.size() ? position[at] : 0) * step) * unit;
  }
  // Names of axes that are x, y and z decide.
  std::vector<AxisRole> named;
  for (const GridAxis& axis : std::span(axes).subspan(skipped))
    if (axis.name == "x" || axis.name == "y" || axis.name == "z")
      named.push_back(axis.name == "x" ? AxisRole::x : axis.name == "y" ? AxisRole::y : AxisRole::z);
  const bool distinct = named.size() == 3 && named[0] != named[1] && named[1] != named[2] && named[0] != named[2];
  for (std::size_t i = 0; distinct && i < named.size() && rank == 3 + skipped; ++i) axes[skipped + i].role = named[i];
  return axes;
}

GridSpec mesh_spec(DatasetTree& tree, const std::string& path) {
  GridSpec spec;
  const std::string record = record_of(tree, path);
  const std::vector<std::string> names = record_arrays(tree, path);
  for (const std::string& name : names)
    if (tree.find(name)->shape == tree.find(names.front())->shape) spec.arrays.push_back(*tree.index_of(name));
  spec.path = path;
  if (spec.arrays.empty()) return spec;
  const ArrayInfo& array = tree.arrays()[spec.arrays.front()];
  const std::string geometry = tree.text(record, "geometry");
  spec.axes = mesh_axes(tree, record, array, geometry == "thetaMode");
  spec.slope = tree.number(array.path, "unitSI").value_or(1);
  if (!std::isfinite(spec.slope) || spec.slope == 0) spec.slope = 1;
  spec.unit = si_unit(tree.numbers(record, "unitDimension"));
  spec.title = name_of_path(record) + (record == path ? "" : " " + name_of_path(path));
  if (!geometry.empty()) spec.metadata.emplace_back("geometry", geometry);
  if (geometry == "thetaMode")
    spec.metadata.emplace_back("axes", "radius and z of one mode of the angle (--channel chooses the mode)");
  if (spec.arrays.size() > 1) {
    std::string components;
    for (const std::size_t one : spec.arrays)
      components += (components.empty() ? "" : ", ") + name_of_path(tree.arrays()[one].path);
    spec.metadata.emplace_back("components", components);
  }
  spec.metadata.emplace_back("space units", "m");
  return spec;
}

/// Returns the path of the same record in another iteration.
std::string path_in(const std::string& path, const std::string& iteration) {
  constexpr std::size_t kBaseLength = 6;  // of "/data/"
  return "/data/" + iteration + path.substr(std::min(path.find('/', kBaseLength), path.size()));
}

/// Returns the coordinates of particles along an axis, in metres; empty without this axis.
std::vector<double> particle_axis(DatasetTree& tree, const std::string& species, std::string_view axis,
                                  std::size_t& count, MeshBuilder& builder) {
  std::vector<double> sum;
  for (const char* const record : {"position", "positionOffset"}) {
    const std::string path = species + "/" + record + "/" + std::string(axis);
    const double unit = tree.number(path, "unitSI").value_or(1);
    if (const ArrayInfo* const array = tree.find(path)) {
      builder.draw(static_cast<std::uint64_t>(std::min(element_count(*array), 1e12)) * 2 * sizeof(double));
      auto read = tree.values(path);
      if (const auto* const problem = std::get_if<std::string>(&read)) {
        builder.fail(*problem);
        continue;
      }
      const auto& values = std::get<std::vector<double>>(read);
      if (sum.empty()) sum.resize(values.size(), 0);
      for (std::size_t i = 0; i < std::min(values.size(), sum.size()); ++i) sum[i] += values[i] * unit;
      count = std::max(count, values.size());
    } else if (const auto constant = tree.number(path, "value"); constant && count > 0) {
      sum.resize(std::max(sum.size(), count), 0);
      for (double& one : sum) one += *constant * unit;
    }
  }
  return sum;
}

}  // namespace

bool suits_openpmd(DatasetTree& tree) { return tree.attribute("/", "openPMD") != nullptr; }

std::vector<DatasetEntry> list_openpmd(DatasetTree& tree) {
  const std::vector<std::string> steps = iterations(tree);
  std::vector<DatasetEntry> all;
  std::map<std::string, std::vector<const ArrayInfo*>> records;  // of several components, and species of particles
  for (const ArrayInfo& array : tree.arrays()) {
    DatasetEntry entry = entry_of(tree, array);
    const auto place = place_of(tree, array.path);
    if (place && is_readable(array)) {
      const std::string record = record_of(tree, array.path);
      entry.unit = si_unit(tree.numbers(record, "unitDimension"));
      if (place->part == "meshes") {
        if (array.shape.size() >= 2) entry.form = DatasetForm::volume;
        entry.rank = 10;
        if (place->names.size() > 1) records[record].push_back(&array);
      } else {
        const std::string species = "/data/" + place->iteration + "/" + part_name(tree, true) + "/" + place->names[0];
        records[species].push_back(&array);
        const bool of_particles = array.shape.size() == 1 && !array.path.starts_with(species + "/position") &&
                                  !array.path.starts_with(species + "/particlePatches") && !is_bookkeeping(array.path);
        if (of_particles) entry.form = DatasetForm::mesh;
        entry.rank = 1;
      }
    }
    all.push_back(std::move(entry));
  }
  for (const auto& [path, arrays] : records) {
    const auto place = place_of(tree, path);
    const bool particles = place && place->part == "particles";
    DatasetEntry entry = entry_of(tree, *arrays.front());
    entry.path = path;
    entry.unit = si_unit(tree.numbers(path, "unitDimension"));
    const bool first = place && !steps.empty() && place->iteration == steps.front();
    if (particles) {
      entry.note = "particles";
      entry.type = "points";
      entry.unit = {};
      entry.form = DatasetForm::mesh;
      entry.rank = first ? 5 : 4;
    } else if (arrays.size() > 1) {
      entry.type = std::to_string(arrays.size()) + " x " + entry.type;
      entry.form = arrays.front()->shape.size() >= 2 ? DatasetForm::volume : DatasetForm::nothing;
      entry.note = steps.size() > 1 && first ? std::to_string(steps.size()) + " iterations" : "";
      entry.rank = first ? 20 : 15;
    } else {
      continue;
    }
    all.push_back(std::move(entry));
  }
  return all;
}

VolumeResult openpmd_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) {
  GridSpec spec = mesh_spec(tree, entry.path);
  if (spec.arrays.empty()) return std::string("its components are constant");
  const auto place = place_of(tree, entry.path);
  const std::vector<std::string> steps = iterations(tree);
  // The record of the first iteration stands for the series.
  if (!place || steps.size() < 2 || place->iteration != steps.front()) return open_grid(tree, std::move(spec), choice);
  std::vector<std::pair<double, std::string>> series;
  for (const std::string& step : steps)
    if (const std::string path = path_in(entry.path, step); !record_arrays(tree, path).empty())
      series.emplace_back(iteration_time(tree, step), path);
  std::ranges::stable_sort(series, {}, &std::pair<double, std::string>::first);
  std::vector<double> times;
  for (const auto& [time, path] : series) times.push_back(time);
  if (choice.found) choice.found->times = times;
  VoxelComponent one = choice;
  one.step.reset();
  if (choice.step) {
    if (!choice.step->time && choice.step->number >= times.size())
      return "no step " + std::to_string(choice.step->number) + "; expected 0 to " + std::to_string(times.size() - 1);
    return open_grid(tree, mesh_spec(tree, series[qnv::step_number(*choice.step, times)].second), one);
  }
  std::vector<qnv::VolumeSource> all;
  std::vector<double> shown;
  for (const auto& [time, path] : series) {
    VolumeResult made = open_grid(tree, mesh_spec(tree, path), one);
    auto* const volume = std::get_if<qnv::VolumeSource>(&made);
    // Steps of other sizes, as of adaptive grids, are not part of the series.
    if (!volume || (!all.empty() && volume->layout.dimensions != all.front().layout.dimensions)) continue;
    all.push_back(std::move(*volume));
    shown.push_back(time);
  }
  if (all.empty()) return open_grid(tree, std::move(spec), one);
  qnv::VolumeSource source = all.front();
  if (all.size() > 1) {
    source.steps = std::move(all);
    source.times = std::move(shown);
  }
  return source;
}

void openpmd_mesh(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice, MeshBuilder& builder) {
  auto place = place_of(tree, entry.path);
  if (!place) return builder.fail(entry.path + " is no record of particles");
  std::string path = entry.path;
  const std::vector<std::string> steps = iterations(tree);
  std::vector<double> times;
  for (const std::string& step : steps) times.push_back(iteration_time(tree, step));
  if (choice.found && times.size() > 1 && place->iteration == steps.front()) choice.found->times = times;
  if (choice.step && place->iteration == steps.front()) {
    const std::size_t number = choice.step->time ? qnv::step_number(*choice.step, times) : choice.step->number;
    if (number >= steps.size())
      return builder.fail("no step " + std::to_string(number) + "; expected 0 to " + std::to_string(steps.size() - 1));
    path = path_in(entry.path, steps[number]);
    place = place_of(tree, path);
  }
  const std::string species = "/data/" + place->iteration + "/" + part_name(tree, true) + "/" + place->names[0];
  std::size_t count = 0;
  std::array<std::vector<double>, 3> axes;
  static constexpr std::string_view kAxes[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) axes[i] = particle_axis(tree, species, kAxes[i], count, builder);
  if (count == 0) return builder.fail(species + " has no positions");
  PolyData data;
  builder.draw(count * sizeof(glm::vec3));
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3 point(0);
    for (std::size_t k = 0; k < 3; ++k)
      point[static_cast<int>(k)] = i < axes[k].size() ? static_cast<float>(axes[k][i]) : 0.0f;
    data.points.push_back(point);
  }
  if (const ArrayInfo* const array = tree.find(path)) {
    builder.draw(count * (sizeof(float) + sizeof(double)));
    auto read = tree.values(path);
    if (const auto* const problem = std::get_if<std::string>(&read)) return builder.fail(*problem);
    auto& values = std::get<std::vector<double>>(read);
    const double unit = tree.number(path, "unitSI").value_or(1);
    for (double& value : values) value *= unit;
    if (values.size() == count && array->parts == 1) {
      const std::string record = record_of(tree, path);
      set_title(path.substr(species.size() + 1), 1, si_unit(tree.numbers(record, "unitDimension")), choice,
                data.of_points);
      append_values(values, 1, choice, data.of_points);
    }
  }
  build_poly_data(std::move(data), builder);
}

}  // namespace gs::app
