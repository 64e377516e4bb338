#pragma once

#include "app/base/world_budget.h"
#include "app/formats/common/ply_header.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// A PLY file opened at one element of it. The bytes must outlive it.
struct PlyTable {
  PlyHeader header;
  PlyElement element;
  std::size_t rows = 0;             // whole rows that are there, at most element.count
  std::span<const std::byte> data;  // binary: the rows
  std::vector<double> values;       // ascii: all values, row by row
  vrml::Share share;                // that these take

  [[nodiscard]] bool has(std::string_view property) const;
  /// A property of every row as floats; empty where there is none or it is a list.
  [[nodiscard]] std::vector<float> column(std::string_view property) const;
  /// The same without rounding.
  [[nodiscard]] std::vector<double> wide_column(std::string_view property) const;
};

/// Opens element `name`, which may not have lists, nor any before it. A file that ends early has fewer rows.
/// The string says what is wrong.
[[nodiscard]] std::variant<PlyTable, std::string> open_ply_table(std::span<const std::byte> bytes,
                                                                 std::string_view name,
                                                                 const WorldBudget& budget = own_budget());

/// The header alone; nothing where it is broken.
[[nodiscard]] std::optional<PlyHeader> ply_header_of(std::span<const std::byte> bytes);

}  // namespace gs::app
