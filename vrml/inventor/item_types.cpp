#include "vrml/inventor/item_types.h"

#include "vrml/inventor/converter.h"
#include "vrml/inventor/value_reader.h"

#include <deque>
#include <unordered_map>

namespace gs::vrml::inventor {
namespace {

/// Types of all families, by name.
struct Types {
  std::deque<ItemType> types;
  std::unordered_map<std::string_view, const ItemType*> by_name;
};

std::vector<FieldRow> read_fields(std::string_view text) {
  SceneGraph scene("node table of Inventor");
  Diagnostics diagnostics;
  SceneSink sink(scene, diagnostics);
  Lexer lexer;
  lexer.set_window(text.data(), text.data() + text.size(), true);
  ValueReader reader(lexer, sink);
  std::vector<FieldRow> rows;
  for (;;) {
    const Token type = lexer.next();
    const Token name = lexer.next();
    const auto value_type = value_type_named(type.text);
    if (name.kind != TokenKind::word || !value_type) return rows;
    FieldRow row{*value_type, std::string(name.text), initial_of(*value_type)};
    reader.read(row.type, row.initial, row.name);
    rows.push_back(std::move(row));
  }
}

Types read_types() {
  Types all;
  for (const auto rows : {group_rows(), kit_rows(), transform_rows(), animation_rows(), property_rows(), texture_rows(),
                          solid_rows(), text_rows(), face_rows(), line_rows(), viewing_rows(), other_rows()})
    for (const ItemRow& row : rows) {
      const std::vector<FieldRow> fields = row.fields.empty() ? std::vector<FieldRow>() : read_fields(row.fields);
      for (std::string_view names = row.names; !names.empty();) {
        const std::size_t end = std::min(names.find(' '), names.size());
        all.types.push_back(
            {std::string(names.substr(0, end)), row.kind, row.keeps_state, row.apply, fields, row.note});
        names.remove_prefix(std::min(end + 1, names.size()));
      }
    }
  for (const ItemType& type : all.types) all.by_name.emplace(type.name, &type);
  return all;
}

}  // namespace

const ItemType* find_item_type(std::string_view name) {
  static const Types types = read_types();
  auto found = types.by_name.find(name);
  // Old programs write the class name of Inventor, with its prefix.
  if (found == types.by_name.end() && name.starts_with("So")) found = types.by_name.find(name.substr(2));
  return found == types.by_name.end() ? nullptr : found->second;
}

const ItemType& unknown_item_type() {
  static const ItemType type{"", ItemClass::unknown, false, apply_unknown, {}, {}};
  return type;
}

}  // namespace gs::vrml::inventor
