#pragma once

#include "app/formats/datasets/conventions/cf_axes.h"

#include <optional>
#include <string>
#include <utility>

namespace gs::app {

/// Returns true if an array has the values of cells or nodes of a mesh: by UGRID, or with bounds of its coordinates.
[[nodiscard]] bool is_cf_mesh(DatasetTree& tree, const ArrayInfo& array);

/// Returns the paths of the arrays with the longitude and latitude of each element of the last two axes (a curvilinear
/// grid), or nullopt.
[[nodiscard]] std::optional<std::pair<std::string, std::string>> cf_grid_coordinates(DatasetTree& tree,
                                                                                     const ArrayInfo& array);

}  // namespace gs::app
