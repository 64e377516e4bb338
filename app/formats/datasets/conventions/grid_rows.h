#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gs::app {

/// Consecutive rows of an array in a file of datasets.
struct ArrayRows {
  std::string path;                   // empty means no rows
  std::vector<std::uint64_t> before;  // indices on the axes before the axis of the rows
  std::uint64_t first = 0, rows = 0;  // on that axis
  std::size_t columns = 1;            // count of numbers to use from the start of each row
  double base = 0;                    // subtracted from each number

  [[nodiscard]] bool empty() const { return path.empty(); }
};

/// Part of an unstructured grid, as rows of arrays.
struct GridPartRows {
  std::uint64_t points = 0, cells = 0;
  std::uint32_t space = 0;        // parts with equal numbers have the same points
  std::vector<ArrayRows> places;  // one array with three columns, or one array per axis
  // Types, ends and corners of the cells as in VTK, or `element` and rows of corners if all cells have one type.
  ArrayRows types, ends, corners;
  std::uint8_t element = 0;
  ArrayRows values;  // shown values
  ArrayRows hidden_points, hidden_cells;
};

/// Unstructured grid of a file of datasets.
struct GridRows {
  std::vector<GridPartRows> parts;
  std::string title;  // of the values; empty without values
  bool of_points = false;
  bool has_values = false;
};

}  // namespace gs::app
