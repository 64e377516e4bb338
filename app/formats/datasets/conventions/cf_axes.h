#pragma once

#include "app/formats/datasets/arrays/grid_volume.h"

#include <string>
#include <vector>

// Coordinates by the conventions for climate and forecast data: https://cfconventions.org
namespace gs::app {

/// Coordinate of an axis: its array, if there is one, and its meaning.
struct CfAxis {
  std::string name, path;  // `path` is empty without an array
  std::string unit, standard_name;
  std::optional<AxisRole> role;
  std::vector<double> values;  // of the array, unpacked
  bool down = false;           // larger values lie lower
};

/// Returns the coordinates of the axes of an array, with a role for each. Axes without a known meaning become x, y and
/// z from the last one on, then channels.
[[nodiscard]] std::vector<CfAxis> cf_axes(DatasetTree& tree, const ArrayInfo& array);
/// Returns the meaning of a coordinate by its attributes, else by its name.
[[nodiscard]] std::optional<AxisRole> cf_role(DatasetTree& tree, const std::string& path, std::string_view name);
/// Returns true if a coordinate counts degrees of longitude or latitude.
[[nodiscard]] bool is_degrees(std::string_view unit);

/// Returns a time such as "2001-01-16 12:00" from a number in units such as "days since 2001-1-1"; empty if the units
/// are not understood.
[[nodiscard]] std::string cf_date(double number, const std::string& units, const std::string& calendar);

/// Returns the names in an attribute that lists variables, such as `coordinates`, as paths beside `path`.
[[nodiscard]] std::vector<std::string> cf_paths(DatasetTree& tree, const std::string& path, std::string_view attribute);

}  // namespace gs::app
