#pragma once

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

/// Appends values of points or cells: single numbers, or the lengths of vectors of `parts` numbers. Numbers without a
/// whole vector are ignored.
void append_values(std::span<const double> numbers, std::size_t parts, PolyData::Data& data);
/// Sets the title of values: name, "(length)" for vectors, and unit.
void set_title(std::string_view name, std::size_t parts, std::string_view unit, PolyData::Data& data);

/// Appends points of `parts` coordinates each, 1 to 3.
void append_points(std::span<const double> numbers, std::size_t parts, std::vector<glm::vec3>& points);

/// Converts a number to an index; kBadIndex if it is not in 0..count - 1.
[[nodiscard]] std::int32_t index_below(double number, std::size_t count);

}  // namespace gs::app
