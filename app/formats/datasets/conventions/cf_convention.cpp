#include "app/formats/datasets/conventions/cf_axes.h"
#include "app/formats/datasets/conventions/cf_mesh.h"
#include "app/formats/datasets/conventions/conventions_table.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

// Volumes of NetCDF files and others that follow CF.

namespace gs::app {
namespace {

constexpr std::size_t kMostCfAxes = 12;

/// Names of the arrays that describe others: coordinates, bounds, connectivity.
std::set<std::string> helper_arrays(DatasetTree& tree) {
  std::set<std::string> helpers;
  for (const ArrayInfo& array : tree.arrays()) {
    for (const std::string& name : array.dimensions) helpers.insert(name);
    for (const char* const list : {"bounds", "climatology", "coordinates", "grid_mapping", "node_coordinates",
                                   "edge_coordinates", "face_coordinates", "ancillary_variables"})
      for (std::string& path : cf_paths(tree, array.path, list)) helpers.insert(std::move(path));
    if (!tree.text(array.path, "cf_role").empty() || !tree.text(array.path, "grid_mapping_name").empty())
      helpers.insert(array.path);
  }
  return helpers;
}

std::string cf_number_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", number);
  return text;
}

/// Sets the positions of an axis. `scale` converts its values to units of the drawing.
void place_axis(const CfAxis& from, double scale, GridAxis& axis) {
  if (from.values.size() < 2 || !std::ranges::all_of(from.values, [](double v) { return std::isfinite(v); })) {
    if (from.values.size() == 1 && std::isfinite(from.values[0])) axis.first = from.values[0] * scale;
    return;
  }
  axis.first = from.values.front() * scale;
  if (is_even(from.values)) {
    axis.step = (from.values.back() - from.values.front()) / static_cast<double>(from.values.size() - 1) * scale;
    return;
  }
  for (const double value : from.values) axis.positions.push_back(value * scale);
}

double extent_of(const CfAxis* axis, std::uint64_t count) {
  return axis && axis->values.size() > 1 ? std::abs(axis->values.back() - axis->values.front())
                                         : static_cast<double>(count) - 1;
}

/// Sets the positions of all axes. A vertical axis in another unit than the horizontal ones gets a height of a quarter
/// of the width.
void place_axes(std::span<const CfAxis> axes, const ArrayInfo& array, GridSpec& spec) {
  double width = 0;
  std::string unit;
  bool has_coordinates = false;
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (axes[i].role == AxisRole::x || axes[i].role == AxisRole::y) {
      width = std::max(width, extent_of(&axes[i], array.shape[i]));
      if (!axes[i].unit.empty()) unit = axes[i].unit;
      has_coordinates = has_coordinates || axes[i].values.size() > 1;
    }
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const CfAxis& from = axes[i];
    GridAxis& axis = spec.axes[i];
    axis.role = *from.role;
    axis.name = from.name;
    double scale = 1;
    if (axis.role == AxisRole::time) {
      axis.positions = from.values;
      if (!from.unit.empty()) spec.metadata.emplace_back("time unit", from.unit);
      continue;
    }
    if (axis.role == AxisRole::channel || axis.role == AxisRole::component) continue;
    if (axis.role == AxisRole::z && array.shape[i] > 1) {
      const double height = extent_of(&from, array.shape[i]);
      const bool other = has_coordinates && (from.unit != unit || is_degrees(unit));
      constexpr double kShare = 0.25;
      if (other && height > 0 && width > 0) scale = kShare * width / height;
      if (from.down) scale = -scale;
      if (from.values.size() > 1)
        spec.metadata.emplace_back("vertical axis", from.name + " from " + cf_number_text(from.values.front()) +
                                                        " to " + cf_number_text(from.values.back()) + ' ' + from.unit +
                                                        (other ? ", drawn as high as a quarter of the width" : ""));
    }
    place_axis(from, scale, axis);
    if (from.values.size() < 2) axis.step = scale < 0 ? -1 : 1;
    if (!axis.positions.empty())
      spec.metadata.emplace_back("uneven axis", from.name + ", interpolated to even distances");
  }
  if (has_coordinates && !unit.empty()) spec.metadata.emplace_back("space units", is_degrees(unit) ? "degrees" : unit);
}

GridSpec cf_spec(DatasetTree& tree, const ArrayInfo& array) {
  GridSpec spec;
  spec.arrays = {*tree.index_of(array.path)};
  spec.path = array.path;
  spec.axes.resize(array.shape.size());
  read_common_attributes(tree, array, spec);
  for (GridAxis& axis : spec.axes) axis = {};
  const std::vector<CfAxis> axes = cf_axes(tree, array);
  place_axes(axes, array, spec);
  if (const std::string name = tree.text(array.path, "standard_name"); !name.empty())
    spec.metadata.emplace_back("standard name", name);
  const bool by_indices = std::ranges::none_of(axes, [](const CfAxis& axis) {
    return (axis.role == AxisRole::x || axis.role == AxisRole::y) && axis.values.size() > 1;
  });
  if (by_indices && cf_grid_coordinates(tree, array))
    spec.metadata.emplace_back("grid", "curvilinear, drawn by its indices (--globe yes draws it by its coordinates)");
  for (const CfAxis& axis : axes)
    if (axis.role == AxisRole::time && !axis.values.empty()) {
      const std::string calendar = tree.text(axis.path, "calendar");
      const std::string first = cf_date(axis.values.front(), axis.unit, calendar);
      const std::string last = cf_date(axis.values.back(), axis.unit, calendar);
      if (!first.empty())
        spec.metadata.emplace_back(
            "dates", first + (last == first ? "" : " to " + last) + (calendar.empty() ? "" : " (" + calendar + ")"));
    }
  return spec;
}

}  // namespace

bool suits_cf(DatasetTree& tree) {
  const auto& all = tree.arrays();
  const std::string stated = tree.text("/", "Conventions");
  return !stated.empty() || tree.attribute("/", "_NCProperties") ||
         std::ranges::any_of(all, [](const ArrayInfo& array) {
           return !array.dimensions.empty() && array.dimensions.front().starts_with('/');
         });
}

std::vector<DatasetEntry> list_cf(DatasetTree& tree) {
  const std::set<std::string> helpers = helper_arrays(tree);
  std::vector<DatasetEntry> all;
  for (const ArrayInfo& array : tree.arrays()) {
    if (tree.text(array.path, "NAME").starts_with("This is a netCDF dimension but not")) continue;
    DatasetEntry entry = entry_of(tree, array);
    const auto wide = std::ranges::count_if(array.shape, [](std::uint64_t size) { return size > 1; });
    const bool helper = helpers.contains(array.path);
    entry.is_minor = helper;
    constexpr double kClass = 1000;
    if (is_readable(array) && is_cf_mesh(tree, array)) {
      entry.form = DatasetForm::mesh;
      entry.note = "values of a mesh";
      entry.rank = (helper ? 0 : kClass * 4) + std::log2(element_count(array));
    } else if (is_readable(array) && wide >= 1 && array.shape.size() >= 2 && array.shape.size() <= kMostCfAxes &&
               element_count(array) >= 4) {
      entry.form = DatasetForm::volume;
      const std::vector<CfAxis> axes = cf_axes(tree, array);
      const auto space = std::ranges::count_if(axes, [](const CfAxis& axis) { return *axis.role <= AxisRole::z; });
      const auto coordinates = std::ranges::count_if(
          axes, [](const CfAxis& axis) { return *axis.role <= AxisRole::z && axis.values.size() > 1; });
      entry.has_globe = coordinates >= 2 || cf_grid_coordinates(tree, array).has_value();
      const bool flags = !tree.numbers(array.path, "flag_values").empty();
      entry.rank = (helper ? 0 : kClass * (coordinates >= 2 ? 3 : 2)) + (space >= 3 ? kClass / 2 : 0) +
                   std::log2(element_count(array)) - (flags ? kClass / 4 : 0);
    }
    all.push_back(std::move(entry));
  }
  return all;
}

VolumeResult cf_volume(DatasetTree& tree, const DatasetEntry& entry, const VoxelComponent& choice) {
  const ArrayInfo* const array = tree.find(entry.path);
  if (!array) return std::string("there is no such array");
  return open_grid(tree, cf_spec(tree, *array), choice);
}

}  // namespace gs::app
