#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/values/field_value.h"

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

// Nodes of VRML 1.0 and Inventor files as they are written, before their conversion to VRML97.
namespace gs::vrml::inventor {

class Converter;
struct Item;
using ItemPtr = std::shared_ptr<const Item>;

/// Notation of one element of a field's value.
enum class Form : std::uint8_t {
  none,  // no value (SFTrigger)
  boolean,
  integer,
  real,  // one or more numbers
  color,
  rotation,
  text,  // string, in quotes or as a single word
  word,  // enumeration
  mask,  // words in parentheses, separated by `|`
  image,
  node,
};

/// Type of a field. Elements have `numbers` numbers each.
struct ValueType {
  Form form = Form::none;
  std::uint8_t numbers = 1;
  bool multiple = false;
  friend bool operator==(const ValueType&, const ValueType&) = default;
};

/// Declaration of a field.
struct FieldRow {
  ValueType type;
  std::string name;
  FieldValue initial;
};

/// Function that converts a node: it changes the traversal state or adds nodes to the scene.
using Apply = void (*)(Converter& converter, const Item& item);

/// Class of node types, for the parser and the traversal.
enum class ItemClass : std::uint8_t {
  plain,    // node without children
  shape,    // node without children that draws and does not set the state
  group,    // node with children
  kit,      // nodekit, with parts in fields of any name
  ignored,  // engine, dragger or another node that is omitted with a warning; its body has any form
  unknown,  // node type without a row; its children are drawn
};

/// Node type of VRML 1.0 or Inventor.
struct ItemType {
  std::string name;
  ItemClass kind = ItemClass::plain;
  bool keeps_state = false;  // Separator and similar: the state after the node is the state before it
  Apply apply = nullptr;
  std::vector<FieldRow> fields;
  std::string_view note = {};  // warning for the first node of this type; empty if there is none

  [[nodiscard]] const FieldRow* find(std::string_view field) const {
    for (const FieldRow& row : fields)
      if (row.name == field) return &row;
    return nullptr;
  }
};

/// Field of a node with the value in the text.
struct ItemField {
  const FieldRow* row = nullptr;
  FieldValue value;
  std::vector<ItemPtr> nodes;  // nodes of a value with Form::node
  bool ignored = false;        // marked with `~`: the inherited value stays
};

/// Node as it is written.
struct Item {
  const ItemType* type = nullptr;
  std::string name;  // DEF name, or empty
  SourceLocation location;
  std::uint64_t serial = 0;  // unique in the text
  std::vector<ItemField> fields;
  std::vector<ItemPtr> children;

  [[nodiscard]] const ItemField* field(std::string_view field_name) const {
    for (const ItemField& given : fields)
      if (given.row->name == field_name) return &given;
    return nullptr;
  }
  [[nodiscard]] bool is_ignored(std::string_view field_name) const {
    const ItemField* const given = field(field_name);
    return given && given->ignored;
  }
  /// Returns the value in the text, or the default value of the type. Returns an empty value if the type has no such
  /// field, or one of another type.
  template <class T>
  [[nodiscard]] const T& get(std::string_view field_name) const {
    static const T none{};
    const ItemField* const given = field(field_name);
    if (const T* const value = given ? std::get_if<T>(&given->value) : nullptr) return *value;
    const FieldRow* const row = type->find(field_name);
    const T* const initial = row ? std::get_if<T>(&row->initial) : nullptr;
    return initial ? *initial : none;
  }
  [[nodiscard]] std::string_view word(std::string_view field_name) const { return get<SFString>(field_name).view(); }
  /// Returns the first node in a field, or null.
  [[nodiscard]] ItemPtr node(std::string_view field_name) const {
    const ItemField* const given = field(field_name);
    return given && !given->nodes.empty() ? given->nodes.front() : nullptr;
  }
};

}  // namespace gs::vrml::inventor
