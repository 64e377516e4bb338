#pragma once

#include "app/formats/ply/ply_header.h"
#include "base/budget.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// One element of a PLY file, opened for reading. The bytes of the file must outlive the table.
struct PlyTable {
  PlyHeader header;
  PlyElement element;
  std::size_t rows = 0;             // number of complete rows in the file, at most element.count
  std::span<const std::byte> data;  // rows, if the file is binary
  std::vector<double> values;       // all values row by row, if the file is ASCII
  Share share;                      // memory for `values`

  [[nodiscard]] bool has(std::string_view property) const;
  /// Returns the values of one property in all rows, as floats. Empty if the property is missing or a list.
  [[nodiscard]] std::vector<float> column(std::string_view property) const;
  /// Returns the values of one property in all rows, as doubles. Empty if the property is missing or a list.
  [[nodiscard]] std::vector<double> wide_column(std::string_view property) const;
};

/// Opens element `name`. Neither this element nor those before it may have lists. If the file is truncated, the table
/// has fewer rows. Returns a message on failure.
[[nodiscard]] std::variant<PlyTable, std::string> open_ply_table(std::span<const std::byte> bytes,
                                                                 std::string_view name,
                                                                 const WorldBudget& budget = own_budget());

/// Returns `count` rows of a binary table, from row `first` on. They must be in the table.
[[nodiscard]] PlyTable part_of(const PlyTable& table, std::size_t first, std::size_t count);

/// Reads only the header of a PLY file. Returns nullopt if the header is invalid.
[[nodiscard]] std::optional<PlyHeader> ply_header_of(std::span<const std::byte> bytes);

}  // namespace gs::app
