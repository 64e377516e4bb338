#include "vrml/syntax/scene_sink.h"

#include "vrml/scene/prototype.h"
#include "vrml/syntax/stand_ins.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// Part of SceneSink for nodes and their fields, DEF and USE.
namespace gs::vrml {
namespace {

// Returns the role that a node in the field `field` of a built-in node must have (VRML97 4.6.3, 4.6.5). No role means
// that any node is allowed.
Role role_for(std::string_view field) {
  struct Row {
    std::string_view field;
    Role role;
  };
  static constexpr Row kRows[] = {
      {"children", Role::child},
      {"choice", Role::child},
      {"level", Role::child},
      {"proxy", Role::child},
      {"geometry", Role::geometry},
      {"appearance", Role::appearance},
      {"material", Role::material},
      {"texture", Role::texture},
      {"textureTransform", Role::texture_transform},
      {"coord", Role::geometric_property},
      {"color", Role::geometric_property},
      {"normal", Role::geometric_property},
      {"texCoord", Role::geometric_property},
      {"fontStyle", Role::font_style},
      {"source", Role::sound_source},
  };
  for (const Row& row : kRows)
    if (row.field == field) return row.role;
  return Role::none;
}

void check_role(const Node& node, std::string_view field, TextProblems& problems) {
  const Role wanted = role_for(field);
  if (wanted == Role::none || node.type->role == Role::none || has(node.type->role, wanted)) return;
  problems.error(node.location,
                 "a " + node.type->name + " is not allowed in '" + std::string(field) + "' (VRML97 4.6)");
}

// Checks that the measures of a geometry are above 0 (VRML97 6.7, 6.11, 6.14, 6.17, 6.43). Nodes in the body of a PROTO
// are checked for each instance; `said` prevents repeated reports of one node.
void check_measures(const Node& node, std::unordered_set<std::uint64_t>& said, TextProblems& problems) {
  if (node.type->measures.empty() || node.in_prototype_body) return;
  for (const int slot : node.type->measures) {
    const auto* number = std::get_if<SFFloat>(&node.values[slot]);
    const auto* vector = std::get_if<SFVec3f>(&node.values[slot]);
    const std::vector<float> measures = number ? std::vector{*number} : std::vector{vector->x, vector->y, vector->z};
    if (std::all_of(measures.begin(), measures.end(), [](float m) { return m > 0 && std::isfinite(m); })) continue;
    if (!said.insert(std::uint64_t{node.location.line} << 32 | node.location.column).second) return;
    const bool flat = std::all_of(measures.begin(), measures.end(), [](float m) { return m >= 0 && std::isfinite(m); });
    const auto declared = std::find_if(node.type->interfaces.begin(), node.type->interfaces.end(),
                                       [&](const InterfaceDeclaration& field) { return field.slot == slot; });
    problems.report(
        flat ? Severity::warning : Severity::error, node.location,
        node.type->name + '.' + declared->name + ": expected sizes above 0; " + (flat ? "drawn flat" : "not drawn"));
    return;
  }
}

// Makes the type of one Script. Each Script has a separate interface, which its body extends.
NodeType& make_script_type(const NodeType& type, SceneGraph& scene, SourceText& text) {
  auto own = std::make_unique<NodeType>();
  own->name = type.name;
  own->clause = type.clause;
  own->kind = type.kind;
  own->role = type.role;
  own->behaviour = type.behaviour;
  own->url_content = type.url_content;
  (void)scene.memory().charge(sizeof(NodeType) + type.interfaces.size() * sizeof(InterfaceDeclaration));
  for (const InterfaceDeclaration& declaration : type.interfaces) own->declare(declaration);
  return text.add_type(std::move(own));
}

}  // namespace

SceneSink::SceneSink(SceneGraph& scene, Diagnostics& diagnostics)
    : scene_(scene), text_(scene.texts().writing()), problems_(text_, diagnostics), limits_(scene, problems_) {
  scopes_.emplace_back();
}

const NodeType* SceneSink::find_type(std::string_view name) const {
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope) {
    const auto found = scope->types.find(name);
    if (found == scope->types.end()) continue;
    const NodeType* native = stood_for(*found->second);
    return native ? native : found->second;
  }
  return built_in_node_type(name);
}

const NodeType* SceneSink::find_stand_in(SourceName name) {
  const auto known = stand_ins_.find(name.text);
  if (known != stand_ins_.end()) return known->second;
  const NodeType* type = stand_in(scene_, name.text);
  if (!type) return nullptr;
  stand_ins_.emplace(type->name, type);
  problems_.warn(
      name.location,
      quoted(name.text) + " is not a VRML97 node, but an extension of other browsers; a stand-in replaces it");
  return type;
}

// Reports each unknown type once, unless there are too many to remember. A USE of the skipped node gives no further
// error.
void SceneSink::skip_unknown(const NodeHeader& header) {
  constexpr std::size_t kMaxTypes = 1000;
  const std::string type(header.type.text);
  const bool known = unknown_types_.contains(type);
  if (!known) problems_.error(header.type.location, "unknown node type " + quoted(type) + "; the node is skipped");
  if (!known && unknown_types_.size() < kMaxTypes) unknown_types_.insert(type);
  NameTable& names = scopes_.back().names;
  if (!header.name.empty() && !names.find(header.name))
    if (const std::string* const kept = scene_.texts().keep_name(header.name)) names.insert(*kept);
}

OpenNode SceneSink::begin_node(const NodeHeader& header) {
  const SourceLocation location = header.type.location;
  OpenNode node;
  node.type = find_type(header.type.text);
  if (!node.type) node.type = find_stand_in(header.type);
  if (!node.type) {
    skip_unknown(header);
    return {};
  }
  if (node.type->kind == NodeType::Kind::script)
    node.type = node.own_type = &make_script_type(*node.type, scene_, text_);
  node.id = scene_.create(*node.type, location);
  if (!node.id) {
    if (!scene_.memory().exhausted() && limits_.is_first_excess())
      problems_.error(location, "more than " + std::to_string(scene_.limits().nodes) + " nodes; the rest is left out");
    return {};
  }
  Scope& scope = scopes_.back();
  if (in_prototype_body()) scene_.put_in_body(node.id, *scope.prototype->prototype);
  if (!header.name.empty()) {
    scene_.node(node.id).name = *scene_.texts().keep_name(header.name);
    scope.names.insert(scene_.node(node.id).name) = node.id;
  }
  place(node.id, header.target);
  if (!limits_.admits_depth(header.depth, location)) return {};
  if (!header.target.field.empty()) check_role(scene_.node(node.id), header.target.field, problems_);
  ++scope.open_nodes;
  return node;
}

void SceneSink::place(NodeId node, NodeTarget target) {
  (void)scene_.memory().charge(target.value ? sizeof(NodeId) : sizeof(Statement));
  if (target.value) {
    if (auto* list = std::get_if<MFNode>(target.value)) {
      list->push_back(node);
    } else {
      *std::get_if<SFNode>(target.value) = node;
    }
  } else if (scopes_.back().prototype) {
    statements().push_back({Statement::Kind::node, node, nullptr, {}});
  } else {
    text_.add_root(node);
  }
}

void SceneSink::end_node(NodeId id) {
  --scopes_.back().open_nodes;
  check_measures(scene_.node(id), said_measures_, problems_);
  const NodeType& type = *scene_.node(id).type;
  if (!type.prototype) return;
  const auto before = static_cast<std::uint32_t>(scene_.nodes().count());
  if (!instantiate(scene_, id) && !scene_.budget()->stopped() && limits_.is_first_excess())
    problems_.error(scene_.node(id).location, why_not_expanded(scene_, type) + "; the missing parts stay empty");
  for (std::uint32_t i = before + 1; i <= scene_.nodes().count(); ++i)
    check_measures(scene_.node(scene_.nodes().id_at(i)), said_measures_, problems_);
}

void SceneSink::use_node(SourceName name, NodeTarget target) {
  const NodeId* const found = scopes_.back().names.find(name.text);
  if (!found) {
    problems_.error(name.location, "USE of " + quoted(name.text) + ", but no earlier DEF has this name");
  } else if (*found) {
    place(*found, target);
  }
}

const InterfaceDeclaration* SceneSink::find_field(const OpenNode& node, SourceName name) {
  const NodeType& type = *node.type;
  const InterfaceDeclaration* const declaration = type.find_field(name.text);
  if (declaration || type.stands_in) return declaration;
  const bool event = type.find_event_in(name.text) || type.find_event_out(name.text);
  problems_.error(name.location,
                  event ? quoted(name.text) + " of " + type.name + " is an event and takes no value; skipped"
                        : type.name + " has no field " + quoted(name.text) + "; skipped");
  return nullptr;
}

NodeTarget SceneSink::target_of(const OpenNode& node, const InterfaceDeclaration& field) {
  const bool restricted = node.type->kind == NodeType::Kind::built_in;
  return {&scene_.node(node.id).values[field.slot], restricted ? field.name : std::string_view{}};
}

void SceneSink::field_given(OpenNode& node, const InterfaceDeclaration& field, SourceName name) {
  if (field.slot >= 64) return;
  const std::uint64_t bit = std::uint64_t{1} << field.slot;
  if (node.fields_given & bit)
    problems_.warn(name.location,
                   quoted(name.text) + " of " + node.type->name + " is given twice; the last one is used");
  node.fields_given |= bit;
  scene_.node(node.id).fields_set |= bit;
}

}  // namespace gs::vrml
