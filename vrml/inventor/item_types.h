#pragma once

#include "vrml/inventor/item.h"

#include <span>
#include <string_view>

// Table of the node types of VRML 1.0 and Inventor 2.1. Each family has its rows in one file.
namespace gs::vrml::inventor {

/// Row of the table. `fields` declares one field in each line: type, name, default value.
struct ItemRow {
  std::string_view names;  // names of the type, separated by blanks
  ItemClass kind;
  bool keeps_state;
  Apply apply;  // null if the node has no effect
  std::string_view fields = {};
  std::string_view note = {};  // warning for the first node of the type; empty if there is none
};

[[nodiscard]] std::span<const ItemRow> group_rows();
[[nodiscard]] std::span<const ItemRow> kit_rows();
[[nodiscard]] std::span<const ItemRow> transform_rows();
[[nodiscard]] std::span<const ItemRow> animation_rows();
[[nodiscard]] std::span<const ItemRow> property_rows();
[[nodiscard]] std::span<const ItemRow> texture_rows();
[[nodiscard]] std::span<const ItemRow> solid_rows();
[[nodiscard]] std::span<const ItemRow> text_rows();
[[nodiscard]] std::span<const ItemRow> face_rows();
[[nodiscard]] std::span<const ItemRow> line_rows();
[[nodiscard]] std::span<const ItemRow> viewing_rows();
[[nodiscard]] std::span<const ItemRow> other_rows();

/// Returns the type with this name, or null.
[[nodiscard]] const ItemType* find_item_type(std::string_view name);
/// Returns the type of nodes without a row: a group.
[[nodiscard]] const ItemType& unknown_item_type();

}  // namespace gs::vrml::inventor
