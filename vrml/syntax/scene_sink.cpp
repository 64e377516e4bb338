#include "vrml/syntax/scene_sink.h"

#include "vrml/scene/imported_use.h"

#include "base/text.h"
#include "vrml/scene/coordinates/units.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/stand_ins.h"
#include "vrml/syntax/tokens/name_map.h"

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
  static constexpr NameMap kRoles({std::pair<std::string_view, Role>{"children", Role::child},
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
                                   {"source", Role::sound_source}});
  return kRoles.find(field, Role::none);
}

bool fits(const NodeType& type, std::string_view field) {
  const Role wanted = role_for(field);
  return wanted == Role::none || type.role == Role::none || has(type.role, wanted);
}

// Reports whether a node of a Shape stands between the children of a group. It needs a Shape around it.
bool needs_shape(const NodeType& type, std::string_view field) {
  if (fits(type, field) || role_for(field) != Role::child) return false;
  return has(type.role, Role::geometry) || (field == "children" && has(type.role, Role::appearance));
}

// Reports whether meant_node() may find a node for the field in a node of this type. A Switch may stand in a field of a
// Shape and choose between nodes that fit there.
bool may_contain(const NodeType& type, std::string_view field) {
  const Role wanted = role_for(field);
  if (field == "choice")
    return has(type.role, Role::appearance) || has(type.role, Role::material) || has(type.role, Role::texture);
  const bool of_shape = has(wanted, Role::geometry) || has(wanted, Role::appearance);
  const bool of_appearance = has(wanted, Role::material) || has(wanted, Role::texture);
  if (!of_shape && !of_appearance) return false;
  if (type.read_as == NodeKind::switch_node || type.read_as == NodeKind::group || type.read_as == NodeKind::shape)
    return true;
  if (has(type.role, Role::appearance)) return of_appearance;
  return has(wanted, Role::appearance) && (has(type.role, Role::material) || has(type.role, Role::texture));
}

// Reports a node that does not fit into its field.
void report_role(const NodeType& type, SourceLocation location, std::string_view field, TextProblems& problems) {
  const bool vowel = std::string_view("AEIO").find(type.name.front()) != std::string_view::npos;
  std::string problem =
      (vowel ? "an " : "a ") + type.name + " is not allowed in '" + std::string(field) + "' (VRML97 4.6)";
  if (needs_shape(type, field))
    problems.warn(location, problem + "; put into a Shape");
  else if (may_contain(type, field))
    problems.warn(location, problem + "; the part that fits is used");
  else
    problems.error(location, std::move(problem));
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
  own->read_as = type.read_as;
  own->language = type.language;
  own->component = type.component;
  own->level = type.level;
  own->container_field = type.container_field;
  own->bases = type.bases;
  own->is_programmable = type.is_programmable;
  own->ignored = type.ignored;
  (void)scene.memory().charge(sizeof(NodeType) + type.interfaces.size() * sizeof(InterfaceDeclaration));
  for (const InterfaceDeclaration& declaration : type.interfaces) own->declare(declaration);
  return text.add_type(std::move(own));
}

}  // namespace

SceneSink::SceneSink(SceneGraph& scene, Diagnostics& diagnostics)
    : scene_(scene),
      text_(scene.texts().writing()),
      problems_(text_, diagnostics),
      limits_(scene, problems_),
      routes_before_(scene.routes().size()) {
  scopes_.emplace_back();
}

const NodeType* SceneSink::find_type(std::string_view name) {
  if (const NodeType* const recent = recent_types_.find(text_.language(), name)) return recent;
  const NodeType* const found = search_type(name);
  if (found) recent_types_.add(*found);
  return found;
}

const NodeType* SceneSink::search_type(std::string_view name) const {
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope) {
    const auto found = scope->types.find(name);
    if (found == scope->types.end()) continue;
    const NodeType* native = stood_for(*found->second);
    return native ? native : found->second;
  }
  constexpr int kX3D4 = 40;
  const bool former = text_.language() == Language::x3d && text_.version() < kX3D4;
  const NodeType* const type = former ? former_x3d_type(name) : nullptr;
  return type ? type : built_in_node_type(text_.language(), name);
}

// Returns the X3D type with this name, for a VRML97 text.
const NodeType* SceneSink::find_x3d_type(SourceName name) {
  if (text_.language() == Language::x3d) return nullptr;
  // Files with a VRML97 header are older than X3D 4.
  const NodeType* type = former_x3d_type(name.text);
  if (!type) type = built_in_node_type(Language::x3d, name.text);
  if (type && said_types_.insert(type->name).second)
    problems_.warn(name.location, quoted(name.text) + " is a node of X3D, not of VRML97; read as in X3D");
  return type;
}

// Warns once about each type without effect.
void SceneSink::check_support(const NodeType& type, SourceLocation location) {
  if (type.ignored && said_types_.insert(type.name).second)
    problems_.warn(location,
                   type.name + " (component " + type.component + ") is not supported; the node has no effect");
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
  // X3D has many extensions of other browsers.
  const Severity severity = text_.language() == Language::x3d ? Severity::warning : Severity::error;
  if (!known)
    problems_.report(severity, header.type.location, "unknown node type " + quoted(type) + "; the node is skipped");
  if (!known && unknown_types_.size() < kMaxTypes) unknown_types_.insert(type);
  NameTable& names = scopes_.back().names;
  if (!header.name.empty() && !names.find(header.name))
    if (const std::string* const kept = scene_.texts().keep_name(header.name)) names.insert(*kept);
}

OpenNode SceneSink::begin_node(const NodeHeader& header) {
  const SourceLocation location = header.type.location;
  OpenNode node;
  node.type = find_type(header.type.text);
  // Nodes of X3D that this browser draws are better than stand-ins.
  const NodeType* const x3d = node.type ? nullptr : built_in_node_type(Language::x3d, header.type.text);
  if (x3d && x3d->read_as != NodeKind::other) node.type = find_x3d_type(header.type);
  if (!node.type) node.type = find_stand_in(header.type);
  if (!node.type) node.type = find_x3d_type(header.type);
  if (!node.type) {
    skip_unknown(header);
    return {};
  }
  if (node.type->is_programmable) node.type = node.own_type = &make_script_type(*node.type, scene_, text_);
  node.id = scene_.create(*node.type, location);
  if (!node.id) {
    if (!scene_.memory().exhausted() && limits_.is_first_excess())
      problems_.error(location, "more than " + std::to_string(scene_.limits().nodes) + " nodes; skipped the rest");
    return {};
  }
  check_support(*node.type, location);
  Scope& scope = scopes_.back();
  if (in_prototype_body()) scene_.put_in_body(node.id, *scope.prototype->prototype);
  if (!header.name.empty()) name_node(node, {header.name, location});
  place_checked(node.id, header.target, location);
  if (!limits_.admits_depth(header.depth, location)) return {};
  ++scope.open_nodes;
  return node;
}

void SceneSink::name_node(const OpenNode& node, SourceName name) {
  scene_.node(node.id).name = *scene_.texts().keep_name(name.text);
  scopes_.back().names.insert(scene_.node(node.id).name) = node.id;
}

// Adds a node to its destination. Reports misplaced nodes, and puts parts of a Shape between children into a Shape.
void SceneSink::place_checked(NodeId node, NodeTarget target, SourceLocation location) {
  if (target.field.empty()) return place(node, target);
  const NodeType& type = *scene_.node(node).type;
  if (fits(type, target.field)) return place(node, target);
  report_role(type, location, target.field, problems_);
  if (!needs_shape(type, target.field) || !place_in_shape(node, target)) place(node, target);
}

// Puts a geometry or an Appearance into a new Shape, or into the Shape that was made for the previous child, if that
// lacks such a node. Returns false if there is no memory.
bool SceneSink::place_in_shape(NodeId node, NodeTarget target) {
  const char* const field = has(scene_.node(node).type->role, Role::geometry) ? "geometry" : "appearance";
  const auto* list = std::get_if<MFNode>(target.value);
  const bool follows = made_shape_ && list && !list->empty() && list->back() == made_shape_;
  if (!follows || scene_.get<SFNode>(made_shape_, field)) {
    made_shape_ = scene_.create(built_in_node_type(NodeKind::shape), scene_.node(node).location);
    if (!made_shape_) return false;
    if (in_prototype_body()) scene_.put_in_body(made_shape_, *scopes_.back().prototype->prototype);
    place(made_shape_, target);
  }
  scene_.set(made_shape_, field, SFNode{node});
  return true;
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
    scopes_.back().statements(text_).push_back({Statement::Kind::node, node, nullptr, {}});
  } else {
    text_.add_root(node);
  }
}

double SceneSink::Measures::unit_of(const NodeType& type, const InterfaceDeclaration& field) const {
  const auto known = of_fields.find(&field);
  return units.of(known == of_fields.end() ? measure_of(type, field) : known->second);
}

void SceneSink::Measures::convert_lists(Node& node) const {
  for (const InterfaceDeclaration& field : node.type->interfaces) {
    const bool given = field.slot >= 0 && field.slot < 64 && (node.fields_set >> field.slot & 1) != 0;
    if (const double unit = given && is_multiple(field.type) ? unit_of(*node.type, field) : 1; unit != 1)
      scale_measures(node.values[field.slot], unit);
  }
}

void SceneSink::end_node(NodeId id) {
  --scopes_.back().open_nodes;
  if (!measures_.units.are_standard()) measures_.convert_lists(scene_.node(id));
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
  if (!found && x3d_.is_imported(name.text)) {
    use_imported(name, target);
  } else if (!found) {
    problems_.error(name.location, "USE of " + quoted(name.text) + ", but no earlier DEF has this name");
  } else if (*found) {
    place_checked(*found, target, name.location);
  }
}

// Places a node that stands for an imported node, because the Inline may not be loaded yet. This is possible only
// between the children of a group, because the type of the imported node is unknown.
void SceneSink::use_imported(SourceName name, NodeTarget target) {
  const bool is_child = target.field.empty() || role_for(target.field) == Role::child;
  if (!is_child || scopes_.back().prototype) {
    problems_.error(name.location, "USE of " + quoted(name.text) +
                                       ", a node of another file; only ROUTEs and groups may use imported nodes");
    return;
  }
  const NodeId made = scene_.create(imported_use_type(), name.location);
  if (!made) return;
  scene_.set<SFString>(made, "name", SFString(name.text));
  place(made, target);
}

// Reports a field or event of other browsers once. Returns false for other names.
bool SceneSink::take_extension(const NodeType& type, SourceName name) {
  if (!is_extension_field(type, name.text)) return false;
  if (said_extensions_.insert(type.name + '.' + std::string(name.text)).second)
    problems_.warn(name.location,
                   quoted(name.text) + " of " + type.name + " is an extension of other browsers; skipped");
  return true;
}

// Reports whether unknown interfaces of nodes of this type are ignored without an error: those of stand-ins, and of
// nodes of X3D in VRML97 texts, where the node may be the extension of another browser.
bool SceneSink::is_lenient(const NodeType& type) const {
  return type.stands_in ||
         (type.language == Language::x3d && text_.language() == Language::vrml97 && !built_in_node_type(type.name));
}

// Returns the X3D type that extends the type of a node in a VRML97 text, if it has this field or event.
const NodeType* SceneSink::x3d_type_with(NodeId node, std::string_view interface) const {
  if (text_.language() != Language::vrml97) return nullptr;
  const NodeType* const x3d = x3d_extension_of(*scene_.node(node).type);
  const bool known = x3d && (x3d->find(interface) || x3d->find_event_in(interface) || x3d->find_event_out(interface));
  return known ? x3d : nullptr;
}

// Gives a node in a VRML97 text the X3D type of its name if that type has the field or event. The values of its VRML97
// fields stay, also the default values. Reports each type and name once. Returns false if nothing changes.
bool SceneSink::extend(NodeId node, SourceName interface) {
  const NodeType* const x3d = x3d_type_with(node, interface.text);
  if (!x3d || !scene_.nodes().extend(node, *x3d)) return false;
  scopes_.back().has_extended = true;
  if (said_extensions_.insert(x3d->name + '.' + std::string(interface.text)).second)
    problems_.warn(interface.location,
                   quoted(interface.text) + " of " + x3d->name + " is of X3D, not of VRML97; read as in X3D");
  return true;
}

// Adds a field that all Scripts of X3D have to a Script in a VRML97 text. Returns null if X3D has no such field.
const InterfaceDeclaration* SceneSink::add_script_field(OpenNode& node, SourceName name) {
  if (text_.language() != Language::vrml97 || node.type->kind != NodeType::Kind::script) return nullptr;
  const NodeType* const x3d = built_in_node_type(Language::x3d, node.type->name);
  const InterfaceDeclaration* const field = x3d ? x3d->find_field(name.text) : nullptr;
  if (!field || !node.own_type) return nullptr;
  prototypes_.declare(*node.own_type, node.id, *field);
  if (said_extensions_.insert(x3d->name + '.' + std::string(name.text)).second)
    problems_.warn(name.location, quoted(name.text) + " of " + x3d->name + " is of X3D, not of VRML97; read as in X3D");
  return node.own_type->find_field(name.text);
}

const InterfaceDeclaration* SceneSink::find_field(OpenNode& node, SourceName name) {
  const InterfaceDeclaration* declaration = node.type->find_field(name.text);
  if (declaration || is_lenient(*node.type)) return declaration;
  if (const NodeType* const x3d = x3d_type_with(node.id, name.text); x3d && x3d->find_field(name.text))
    if (extend(node.id, name)) node.type = x3d;
  declaration = node.type->find_field(name.text);
  if (!declaration) declaration = add_script_field(node, name);
  const NodeType& type = *node.type;
  if (declaration || take_extension(type, name)) return declaration;
  const bool event = type.find_event_in(name.text) || type.find_event_out(name.text);
  problems_.error(name.location,
                  event ? quoted(name.text) + " of " + type.name + " is an event and takes no value; skipped"
                        : type.name + " has no field " + quoted(name.text) + "; skipped");
  return nullptr;
}

NodeTarget SceneSink::target_of(const OpenNode& node, const InterfaceDeclaration& field) {
  const bool restricted = node.type->kind == NodeType::Kind::built_in && !node.type->ignored;
  return {&scene_.node(node.id).values[field.slot], restricted ? field.name : std::string_view{}};
}

void SceneSink::field_given(OpenNode& node, const InterfaceDeclaration& field, SourceName name) {
  if (field.slot >= 64) return;
  const std::uint64_t bit = std::uint64_t{1} << field.slot;
  if (node.fields_given & bit)
    problems_.warn(name.location,
                   quoted(name.text) + " of " + node.type->name + " is given twice; the last one is used");
  node.fields_given |= bit;
  Node& given = scene_.node(node.id);
  given.fields_set |= bit;
  // Lists may get more values, and are converted at the end of the node.
  if (measures_.units.are_standard() || is_multiple(field.type)) return;
  if (const double unit = measures_.unit_of(*node.type, field); unit != 1)
    scale_measures(given.values[field.slot], unit);
}

std::vector<Statement>& SceneSink::Scope::statements(SourceText& text) {
  return prototype ? prototype->prototype->statements : text.statements();
}

void SceneSink::finish() {
  x3d_.resolve_names();
  routes_.finish();
}

}  // namespace gs::vrml
