#include "vrml/scene/coordinates/units.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/scene_sink.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// Part of SceneSink for PROTO, EXTERNPROTO, IS and ROUTE.
namespace gs::vrml {
namespace {

// Reports whether `inner` of a node in a PROTO body may be IS `outer` of the PROTO's interface (VRML97 Table 4.4).
bool may_be_mapped(AccessType inner, AccessType outer) { return inner == outer || inner == AccessType::exposedField; }

}  // namespace

std::vector<Statement>& SceneSink::statement_list() {
  NodeType* const prototype = scopes_.back().prototype;
  return prototype ? prototype->prototype->statements : text_.statements();
}

NodeType& SceneSink::begin_prototype(SourceName name, bool external) {
  auto type = std::make_unique<NodeType>();
  type->name = name.text;
  type->location = name.location;
  type->kind = external ? NodeType::Kind::external_prototype : NodeType::Kind::prototype;
  if (!external) {
    type->prototype = std::make_unique<Prototype>();
    type->prototype->scene = &scene_;
    type->prototype->text = &text_;
  }
  (void)scene_.memory().charge(sizeof(NodeType) + sizeof(Prototype));
  ++open_interfaces_;
  return text_.add_type(std::move(type));
}

bool SceneSink::may_declare(const NodeType& type, const InterfaceDeclaration& declaration, SourceLocation location) {
  const bool script = type.kind == NodeType::Kind::script;
  if (script && declaration.access == AccessType::exposedField && text_.language() == Language::vrml97)
    problems_.warn(location,
                   "a Script has no exposedFields in VRML97 (6.40); " + quoted(declaration.name) + " is accepted");
  const InterfaceDeclaration* const known = type.find(declaration.name);
  if (!known) return true;
  if (!script || known->access != declaration.access || known->type != declaration.type)
    problems_.error(location,
                    quoted(declaration.name) + " of " + type.name + " is declared twice; the first one is used");
  (void)scene_.memory().charge(sizeof(InterfaceDeclaration));
  return false;
}

void SceneSink::declare(NodeType& type, NodeId script, InterfaceDeclaration declaration) {
  (void)scene_.memory().charge(sizeof(InterfaceDeclaration));
  if (const double unit = units_.of(measure_of(type, declaration)); unit != 1)
    scale_measures(declaration.initial, unit);
  if (script) {
    scene_.declare(script, type, std::move(declaration));
  } else {
    type.declare(std::move(declaration));
  }
}

void SceneSink::begin_body(NodeType& type) {
  Scope& scope = scopes_.emplace_back();
  scope.prototype = &type;
  scope.interfaces_around = open_interfaces_;
}

// Converts the default values of fields that IS connects to a measure. declare() has converted the rotations.
void SceneSink::convert_prototype(NodeType& type) {
  for (const IsMapping& mapping : type.prototype->mappings) {
    const bool converted = measure_of(type, *mapping.outer) != Measure::none || measures_.contains(mapping.outer);
    if (mapping.outer->slot < 0 || converted) continue;
    const auto known = measures_.find(mapping.inner);
    const Measure measure =
        known == measures_.end() ? measure_of(*scene_.node(mapping.node).type, *mapping.inner) : known->second;
    if (measure == Measure::none) continue;
    measures_.emplace(mapping.outer, measure);
    scale_measures(type.defaults[static_cast<std::size_t>(mapping.outer->slot)], units_.of(measure));
  }
  for (InterfaceDeclaration& field : type.interfaces)
    if (measures_.contains(&field)) field.initial = type.defaults[static_cast<std::size_t>(field.slot)];
}

void SceneSink::end_body() {
  finish();
  NodeType& type = *scopes_.back().prototype;
  scopes_.pop_back();
  recent_types_.clear();
  type.prototype->complete = true;
  if (!units_.are_standard()) convert_prototype(type);
  count_instance_nodes(scene_, *type.prototype);
  // The first node of the body determines where instances may stand (VRML97 4.8.3).
  for (const Statement& statement : type.prototype->statements) {
    if (statement.kind != Statement::Kind::node) continue;
    type.role = scene_.node(statement.node).type->role;
    break;
  }
  add_type(type);
}

void SceneSink::end_external(NodeType& type, MFString url) {
  type.url = std::move(url);
  add_type(type);
}

// Adds a complete declaration: from here on, nodes with its name have this type. Names of types must be unique (4.8).
// But an extension may have a fallback of the same name for other browsers. A declaration inside a node (Annex A.1) is
// printed before that node.
void SceneSink::add_type(NodeType& type) {
  const NodeType* const built_in = built_in_node_type(text_.language(), type.name);
  const Scope& scope = scopes_.back();
  const NodeType*& known = scopes_.back().types[type.name];
  const bool taken = known || (built_in && !is_extension(built_in->clause));
  if (taken && said_types_.insert(type.name).second)
    problems_.warn(type.location,
                   (known ? '\'' + type.name + "' is already declared" : '\'' + type.name + "' is a built-in node") +
                       " (VRML97 4.8); this PROTO is used from here on");
  known = &type;
  recent_types_.clear();
  std::vector<Statement>& list = statement_list();
  auto position = list.end();
  if (scope.open_nodes > 0 || open_interfaces_ > scope.interfaces_around)
    while (position != list.begin() && (--position)->kind != Statement::Kind::node) {
    }
  list.insert(position, {Statement::Kind::prototype, {}, &type, {}});
}

void SceneSink::connect(OpenNode& node, SourceName inner_name, SourceName outer_name) {
  if (!in_prototype_body()) {
    problems_.error(inner_name.location, "IS outside of a PROTO body");
    return;
  }
  const auto inner_of = [&](const NodeType& type) {
    const InterfaceDeclaration* found = type.find(inner_name.text);
    if (!found) found = type.find_event_in(inner_name.text);
    return found ? found : type.find_event_out(inner_name.text);
  };
  if (!inner_of(*node.type) && extend(node.id, inner_name)) node.type = scene_.node(node.id).type;
  const NodeType& type = *node.type;
  const NodeType& prototype = *scopes_.back().prototype;
  const InterfaceDeclaration* const inner = inner_of(type);
  const InterfaceDeclaration* const outer = prototype.find(outer_name.text);
  if (!inner && (is_lenient(type) || type.ignored || take_extension(type, inner_name))) return;
  if (!inner || !outer) {
    problems_.error(inner ? outer_name.location : inner_name.location,
                    inner ? "PROTO " + prototype.name + " has no " + quoted(outer_name.text)
                          : type.name + " has no " + quoted(inner_name.text));
    return;
  }
  const auto mapping = [&](std::string_view of_inner, std::string_view of_outer) {
    return std::string(of_inner) + " " + quoted(inner_name.text) + " IS " + std::string(of_outer) + " " +
           quoted(outer_name.text);
  };
  if (inner->type != outer->type) {
    problems_.error(inner_name.location,
                    mapping(name_of(inner->type), name_of(outer->type)) + "; expected equal types");
    return;
  }
  if (!may_be_mapped(inner->access, outer->access))
    problems_.warn(inner_name.location,
                   mapping(name_of(inner->access, text_.language()), name_of(outer->access, text_.language())) +
                       (text_.language() == Language::x3d ? " (ISO/IEC 19775-1 Table 4.4)" : " (VRML97 Table 4.4)"));
  prototype.prototype->mappings.push_back({node.id, inner, outer});
}

void SceneSink::add_route(const RouteNames& route) {
  Scope& scope = scopes_.back();
  const NodeId* const from = scope.names.find(route.from);
  const NodeId* const to = scope.names.find(route.to);
  // Types of open nodes must not change, because the grammar reads into their values.
  if (from && to && (scope.open_nodes == 0 || !extends_nodes(route, *from, *to))) {
    connect_route(route, *from, *to);
    return;
  }
  constexpr std::size_t kNames = 64;
  (void)scene_.memory().charge(sizeof route + kNames);
  scope.waiting_routes.push_back(route);
}

void SceneSink::finish() {
  x3d_.resolve_names();
  Scope& scope = scopes_.back();
  const std::vector<RouteNames> routes = std::exchange(scope.waiting_routes, {});
  for (const RouteNames& route : routes) {
    for (const std::string* const name : {&route.from, &route.to})
      if (*name == kBrowserName && !scope.names.find(*name)) make_browser(route.location);
    const NodeId* const from = scope.names.find(route.from);
    const NodeId* const to = scope.names.find(route.to);
    if (from && to) {
      connect_route(route, *from, *to);
    } else if (!x3d_.take_route(route)) {
      problems_.error(route.location,
                      "ROUTE names '" + (!from ? route.from : route.to) + "', but no DEF has this name");
    }
  }
  renew_declarations();
}

// Lets IS and ROUTEs of this scope refer to the types that extend() has given to their nodes.
void SceneSink::renew_declarations() {
  if (!std::exchange(scopes_.back().has_extended, false)) return;
  const auto renew = [&](NodeId node, const InterfaceDeclaration*& used) {
    const NodeType* const type = scene_.contains(node) ? scene_.node(node).type : nullptr;
    if (!type || type->kind != NodeType::Kind::built_in || type->language != Language::x3d) return;
    const auto& own = type->interfaces;
    if (std::any_of(own.begin(), own.end(), [&](const auto& each) { return &each == used; })) return;
    if (const InterfaceDeclaration* const found = type->find(used->name)) used = found;
  };
  const auto renew_route = [&](Route& route) {
    renew(route.from, route.event_out);
    renew(route.to, route.event_in);
  };
  for (Statement& statement : statement_list())
    if (statement.kind == Statement::Kind::route) renew_route(statement.route);
  if (NodeType* const prototype = scopes_.back().prototype) {
    for (IsMapping& mapping : prototype->prototype->mappings) renew(mapping.node, mapping.inner);
  } else {
    std::vector<Route>& routes = scene_.routes();
    for (std::size_t i = std::min(routes_before_, routes.size()); i < routes.size(); ++i) renew_route(routes[i]);
  }
}

// Makes the browser as a node of this scope, for its ROUTEs. The node is no part of the scene's hierarchy.
void SceneSink::make_browser(SourceLocation location) {
  const NodeId made = scene_.create(browser_node_type(), location);
  if (!made) return;
  Scope& scope = scopes_.back();
  if (scope.prototype) scene_.put_in_body(made, *scope.prototype->prototype);
  scene_.node(made).name = *scene_.texts().keep_name(kBrowserName);
  scope.names.insert(scene_.node(made).name) = made;
}

// Reports whether a ROUTE needs an event that only the X3D type of one of its nodes has.
bool SceneSink::extends_nodes(const RouteNames& wanted, NodeId from, NodeId to) const {
  if (!from || !to || text_.language() != Language::vrml97) return false;
  const auto* const out = scene_.node(from).type->find_event_out(wanted.event_out);
  const auto* const in = scene_.node(to).type->find_event_in(wanted.event_in);
  if (!out || !in)
    return (!out && x3d_type_with(from, wanted.event_out)) || (!in && x3d_type_with(to, wanted.event_in));
  // X3D gives the eventOut level_changed of an LOD another type.
  const NodeType* const x3d = out->type != in->type ? x3d_type_with(from, wanted.event_out) : nullptr;
  const auto* const own = x3d ? x3d->find_event_out(wanted.event_out) : nullptr;
  return own && own->type == in->type;
}

void SceneSink::connect_route(const RouteNames& wanted, NodeId from, NodeId to) {
  if (!from || !to) return;  // one of the nodes was skipped and reported
  if (extends_nodes(wanted, from, to)) {
    const bool has_in = scene_.node(to).type->find_event_in(wanted.event_in) != nullptr;
    const auto* const out = scene_.node(from).type->find_event_out(wanted.event_out);
    if (!out || has_in) extend(from, {wanted.event_out, wanted.location});
    if (!has_in) extend(to, {wanted.event_in, wanted.location});
  }
  Route route{from, to, nullptr, nullptr};
  const NodeType& from_type = *scene_.node(from).type;
  const NodeType& to_type = *scene_.node(to).type;
  route.event_out = from_type.find_event_out(wanted.event_out);
  route.event_in = to_type.find_event_in(wanted.event_in);
  const auto may_lack = [&](const NodeType& type, const std::string& event) {
    return is_lenient(type) || type.ignored || take_extension(type, {event, wanted.location});
  };
  if ((!route.event_out && may_lack(from_type, wanted.event_out)) ||
      (!route.event_in && may_lack(to_type, wanted.event_in)))
    return;
  if (!route.event_out) {
    problems_.error(wanted.location, from_type.name + " has no eventOut '" + wanted.event_out + "'");
    return;
  }
  if (!route.event_in) {
    problems_.error(wanted.location, to_type.name + " has no eventIn '" + wanted.event_in + "'");
    return;
  }
  if (route.event_out->type != route.event_in->type) {
    problems_.error(wanted.location, "ROUTE from " + std::string(name_of(route.event_out->type)) + " '" +
                                         wanted.event_out + "' to " + std::string(name_of(route.event_in->type)) +
                                         " '" + wanted.event_in + "'; expected equal types");
    return;
  }
  (void)scene_.memory().charge(sizeof(Statement) + sizeof(Route));
  statement_list().push_back({Statement::Kind::route, {}, nullptr, route});
  if (!scopes_.back().prototype) scene_.routes().push_back(route);
}

}  // namespace gs::vrml
