#include "vrml/nodes/families.h"
#include "vrml/scene/node_type.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/parser.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <string>
#include <unordered_map>

namespace gs::vrml {
namespace {

// Reads the range of a field from the comment after its declaration, in the notation of the standard.
void read_ranges(std::string_view text, NodeType& type) {
  std::size_t declaration = 0;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (line.find_first_not_of(' ') == std::string_view::npos) continue;
    const std::size_t comment = line.find("# ");
    if (comment != std::string_view::npos) type.interfaces[declaration].range = line.substr(comment + 2);
    ++declaration;
  }
  if (!has(type.role, Role::geometry)) return;
  for (const InterfaceDeclaration& declared : type.interfaces) {
    const bool length = declared.type == FieldType::SFFloat || declared.type == FieldType::SFVec3f;
    if (declared.access == AccessType::field && length && declared.range == "(0,inf)")
      type.measures.push_back(declared.slot);
  }
}

std::unique_ptr<NodeType> type_of_row(const NodeRow& row) {
  auto type = std::make_unique<NodeType>();
  type->name = row.name;
  type->clause = row.clause;
  type->role = row.role;
  type->read_as = row.read_as;
  type->tessellator = row.tessellator;
  type->behaviour = row.behaviour;
  type->url_content = row.url_content;
  const bool good = parse_interface(row.interface_text, *type);
  assert(good && "a row of the node table does not parse");
  (void)good;
  if (has(row.role, Role::script)) type->kind = NodeType::Kind::script;
  read_ranges(row.interface_text, *type);
  const std::size_t standard = type->interfaces.size();
  const bool good_events = parse_interface(row.other_events, *type);
  assert(good_events && "other events of a row do not parse");
  (void)good_events;
  for (std::size_t i = standard; i < type->interfaces.size(); ++i) type->interfaces[i].of_other_browsers = true;
  return type;
}

struct Table {
  std::vector<std::unique_ptr<NodeType>> types;
  std::unordered_map<std::string_view, const NodeType*> by_name;
  std::map<NodeKind, const NodeType*> by_kind;

  Table() {
    for (const auto rows : {appearance_rows, bindables_rows, common_rows, geometric_properties_rows, geometry_rows,
                            grouping_rows, interpolators_rows, lights_rows, sensors_rows})
      for (const NodeRow& row : rows()) types.push_back(type_of_row(row));
    std::sort(types.begin(), types.end(), [](const auto& a, const auto& b) { return a->name < b->name; });
    for (const auto& type : types) {
      by_name[type->name] = type.get();
      by_kind.emplace(type->read_as, type.get());
    }
  }
};

const Table& table() {
  static const Table the_table;
  return the_table;
}

}  // namespace

std::span<const std::unique_ptr<NodeType>> built_in_node_types() { return table().types; }

const NodeType& browser_node_type() {
  static const std::unique_ptr<NodeType> the_type = type_of_row(browser_rows()[0]);
  return *the_type;
}

const NodeType& browser_event_type() {
  static const std::unique_ptr<NodeType> the_type = type_of_row(browser_rows()[1]);
  return *the_type;
}

const NodeType* stood_for(const NodeType& prototype) {
  const NodeType* native = built_in_node_type(prototype.name);
  if (!native || !is_extension(native->clause) || native->url_content == UrlContent::vectors) return nullptr;
  const bool same = std::all_of(prototype.interfaces.begin(), prototype.interfaces.end(), [&](const auto& declaration) {
    const InterfaceDeclaration* own = native->find(declaration.name);
    return own && own->type == declaration.type && own->access == declaration.access;
  });
  return same ? native : nullptr;
}

const NodeType* built_in_node_type(std::string_view name) {
  const auto found = table().by_name.find(name);
  return found == table().by_name.end() ? nullptr : found->second;
}

const NodeType& built_in_node_type(NodeKind kind) { return *table().by_kind.at(kind); }

}  // namespace gs::vrml
