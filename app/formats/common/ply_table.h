#pragma once

#include "app/formats/common/ply_header.h"
#include "base/budget.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// One element of a PLY file, opened for reading. The bytes must outlive it.
struct PlyTable {
  PlyHeader header;
  PlyElement element;
  std::size_t rows = 0;             // complete rows present, at most element.count
  std::span<const std::byte> data;  // rows of a binary file
  std::vector<double> values;       // all values of an ASCII file, row by row
  Share share;                      // memory of `values`

  [[nodiscard]] bool has(std::string_view property) const;
  /// Returns one property of all rows as floats; empty if it is missing or a list.
  [[nodiscard]] std::vector<float> column(std::string_view property) const;
  /// Returns one property of all rows as doubles; empty if it is missing or a list.
  [[nodiscard]] std::vector<double> wide_column(std::string_view property) const;
};

/// Opens element `name`. Neither it nor an element before it may have lists. A truncated file has fewer rows. Returns a
/// message on failure.
[[nodiscard]] std::variant<PlyTable, std::string> open_ply_table(std::span<const std::byte> bytes,
                                                                 std::string_view name,
                                                                 const WorldBudget& budget = own_budget());

/// Reads only the header. Returns nullopt if it is invalid.
[[nodiscard]] std::optional<PlyHeader> ply_header_of(std::span<const std::byte> bytes);

}  // namespace gs::app
