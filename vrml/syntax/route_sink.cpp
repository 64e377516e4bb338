#include "vrml/syntax/route_sink.h"

#include "vrml/syntax/scene_sink.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace gs::vrml {

void RouteSink::add(const RouteNames& route) {
  SceneSink::Scope& scope = sink_.scopes_.back();
  const NodeId* const from = scope.names.find(route.from);
  const NodeId* const to = scope.names.find(route.to);
  // Types of open nodes must not change, because the grammar reads into their values.
  if (from && to && (scope.open_nodes == 0 || !extends_nodes(route, *from, *to))) {
    connect_route(route, *from, *to);
    return;
  }
  constexpr std::size_t kNames = 64;
  (void)sink_.scene_.memory().charge(sizeof route + kNames);
  scope.waiting_routes.push_back(route);
}

void RouteSink::finish() {
  SceneSink::Scope& scope = sink_.scopes_.back();
  const std::vector<RouteNames> routes = std::exchange(scope.waiting_routes, {});
  for (const RouteNames& route : routes) {
    for (const std::string* const name : {&route.from, &route.to})
      if (*name == kBrowserName && !scope.names.find(*name)) make_browser(route.location);
    const NodeId* const from = scope.names.find(route.from);
    const NodeId* const to = scope.names.find(route.to);
    if (from && to) {
      connect_route(route, *from, *to);
    } else if (!sink_.x3d_.take_route(route)) {
      sink_.problems_.error(route.location,
                            "ROUTE names '" + (!from ? route.from : route.to) + "', but no DEF has this name");
    }
  }
  renew_declarations();
}

// Lets IS and ROUTEs of this scope refer to the types that sink_.extend() has given to their nodes.
void RouteSink::renew_declarations() {
  if (!std::exchange(sink_.scopes_.back().has_extended, false)) return;
  const auto renew = [&](NodeId node, const InterfaceDeclaration*& used) {
    const NodeType* const type = sink_.scene_.contains(node) ? sink_.scene_.node(node).type : nullptr;
    if (!type || type->kind != NodeType::Kind::built_in || type->language != Language::x3d) return;
    const auto& own = type->interfaces;
    if (std::any_of(own.begin(), own.end(), [&](const auto& each) { return &each == used; })) return;
    if (const InterfaceDeclaration* const found = type->find(used->name)) used = found;
  };
  const auto renew_route = [&](Route& route) {
    renew(route.from, route.event_out);
    renew(route.to, route.event_in);
  };
  for (Statement& statement : sink_.scopes_.back().statements(sink_.text_))
    if (statement.kind == Statement::Kind::route) renew_route(statement.route);
  if (NodeType* const prototype = sink_.scopes_.back().prototype) {
    for (IsMapping& mapping : prototype->prototype->mappings) renew(mapping.node, mapping.inner);
  } else {
    std::vector<Route>& routes = sink_.scene_.routes();
    for (std::size_t i = std::min(sink_.routes_before_, routes.size()); i < routes.size(); ++i) renew_route(routes[i]);
  }
}

// Makes the browser as a node of this scope, for its ROUTEs. The node is no part of the scene's hierarchy.
void RouteSink::make_browser(SourceLocation location) {
  const NodeId made = sink_.scene_.create(browser_node_type(), location);
  if (!made) return;
  SceneSink::Scope& scope = sink_.scopes_.back();
  if (scope.prototype) sink_.scene_.put_in_body(made, *scope.prototype->prototype);
  sink_.scene_.node(made).name = *sink_.scene_.texts().keep_name(kBrowserName);
  scope.names.insert(sink_.scene_.node(made).name) = made;
}

// Reports whether a ROUTE needs an event that only the X3D type of one of its nodes has.
bool RouteSink::extends_nodes(const RouteNames& wanted, NodeId from, NodeId to) const {
  if (!from || !to || sink_.text_.language() != Language::vrml97) return false;
  const auto* const out = sink_.scene_.node(from).type->find_event_out(wanted.event_out);
  const auto* const in = sink_.scene_.node(to).type->find_event_in(wanted.event_in);
  if (!out || !in)
    return (!out && sink_.x3d_type_with(from, wanted.event_out)) || (!in && sink_.x3d_type_with(to, wanted.event_in));
  // X3D gives the eventOut level_changed of an LOD another type.
  const NodeType* const x3d = out->type != in->type ? sink_.x3d_type_with(from, wanted.event_out) : nullptr;
  const auto* const own = x3d ? x3d->find_event_out(wanted.event_out) : nullptr;
  return own && own->type == in->type;
}

void RouteSink::connect_route(const RouteNames& wanted, NodeId from, NodeId to) {
  if (!from || !to) return;  // one of the nodes was skipped and reported
  if (extends_nodes(wanted, from, to)) {
    const bool has_in = sink_.scene_.node(to).type->find_event_in(wanted.event_in) != nullptr;
    const auto* const out = sink_.scene_.node(from).type->find_event_out(wanted.event_out);
    if (!out || has_in) sink_.extend(from, {wanted.event_out, wanted.location});
    if (!has_in) sink_.extend(to, {wanted.event_in, wanted.location});
  }
  Route route{from, to, nullptr, nullptr};
  const NodeType& from_type = *sink_.scene_.node(from).type;
  const NodeType& to_type = *sink_.scene_.node(to).type;
  route.event_out = from_type.find_event_out(wanted.event_out);
  route.event_in = to_type.find_event_in(wanted.event_in);
  const auto may_lack = [&](const NodeType& type, const std::string& event) {
    return sink_.is_lenient(type) || type.ignored || sink_.take_extension(type, {event, wanted.location});
  };
  if ((!route.event_out && may_lack(from_type, wanted.event_out)) ||
      (!route.event_in && may_lack(to_type, wanted.event_in)))
    return;
  if (!route.event_out) {
    sink_.problems_.error(wanted.location, from_type.name + " has no eventOut '" + wanted.event_out + "'");
    return;
  }
  if (!route.event_in) {
    sink_.problems_.error(wanted.location, to_type.name + " has no eventIn '" + wanted.event_in + "'");
    return;
  }
  if (route.event_out->type != route.event_in->type) {
    sink_.problems_.error(wanted.location, "ROUTE from " + std::string(name_of(route.event_out->type)) + " '" +
                                               wanted.event_out + "' to " + std::string(name_of(route.event_in->type)) +
                                               " '" + wanted.event_in + "'; expected equal types");
    return;
  }
  (void)sink_.scene_.memory().charge(sizeof(Statement) + sizeof(Route));
  sink_.scopes_.back().statements(sink_.text_).push_back({Statement::Kind::route, {}, nullptr, route});
  if (!sink_.scopes_.back().prototype) sink_.scene_.routes().push_back(route);
}

}  // namespace gs::vrml
