#pragma once

#include "app/formats/common/dataset_list.h"
#include "app/formats/vtk/bookkeeping.h"
#include "app/formats/vtk/poly_data.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Parts of readers that make meshes of arrays.
namespace gs::app {

/// Appends values of points or cells: single numbers, or of vectors of `parts` numbers the chosen number or the length.
/// Numbers without a whole vector are ignored.
void append_values(std::span<const double> numbers, std::size_t parts, const VoxelComponent& choice,
                   PolyData::Data& data);
/// Sets the title of values: name, "(length)" or component for vectors, and unit. Notes the number of components.
void set_title(std::string_view name, std::size_t parts, std::string_view unit, const VoxelComponent& choice,
               PolyData::Data& data);

/// Appends points of `parts` coordinates each, 1 to 3.
void append_points(std::span<const double> numbers, std::size_t parts, std::vector<glm::vec3>& points);

/// Converts a number to an index; kBadIndex if it is not in 0..count - 1.
[[nodiscard]] std::int32_t index_below(double number, std::size_t count);

}  // namespace gs::app
