#include "vrml/events/route_table.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <optional>

namespace gs::vrml {
namespace {

// Approximate memory of a ROUTE in the table, in bytes.
constexpr std::size_t kRouteEntry = 48;

std::uint64_t key_of(std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32 | to; }

bool sends(const InterfaceDeclaration& declaration) {
  return declaration.access == AccessType::eventOut || declaration.access == AccessType::exposedField;
}
bool receives(const InterfaceDeclaration& declaration) {
  return declaration.access == AccessType::eventIn || declaration.access == AccessType::exposedField;
}

}  // namespace

bool RouteTable::find_ends(SceneGraph& from_scene, SceneGraph& to_scene, const Route& route, Ends& ends) {
  if (!from_scene.contains(route.from) || !to_scene.contains(route.to) || !route.event_out || !route.event_in)
    return false;
  if (route.event_out->type != route.event_in->type || !sends(*route.event_out) || !receives(*route.event_in))
    return false;
  if (&from_scene != &to_scene && holds_nodes(route.event_in->type)) return false;
  WorldScenes& scenes = execution_.scenes();
  const EventNode from = scenes.member(scenes.state_of(from_scene), route.from);
  ends.target = scenes.member(scenes.state_of(to_scene), route.to);
  if (from == 0 || ends.target == 0) return false;
  const EventNodes& nodes = execution_.nodes();
  const std::uint32_t event_out = nodes[from].schema->find(*route.event_out);
  ends.event_in = nodes[ends.target].schema->find(*route.event_in);
  if (event_out == EventSchema::kNone || ends.event_in == EventSchema::kNone) return false;
  ends.source = from;
  ends.from = nodes[from].first_slot + event_out;
  ends.to = nodes[ends.target].first_slot + ends.event_in;
  return true;
}

bool RouteTable::add(SceneGraph& from, SceneGraph& to, const Route& route) {
  Ends ends;
  if (!find_ends(from, to, route, ends) || routes_.contains(key_of(ends.from, ends.to)) ||
      !execution_.budget().afford(kRouteEntry))
    return false;
  const std::uint32_t made = connect(ends.source, ends.from, ends.target, ends.event_in, Way::route);
  if (made == 0) {
    execution_.budget().give_back(kRouteEntry);
    return false;
  }
  routes_.emplace(key_of(ends.from, ends.to), made);
  ++revision_;
  note_listener(ends.source);
  return true;
}

// Tells a node that another node listens to its events from now on.
void RouteTable::note_listener(EventNode source) {
  const Behaviour* const behaviour = execution_.nodes().schema_of(source).behaviour;
  if (behaviour && behaviour->watches_routes) execution_.timers().look_again(source);
}

bool RouteTable::remove(SceneGraph& scene, const Route& route) {
  Ends ends;
  if (!find_ends(scene, scene, route, ends)) return false;
  const auto found = routes_.find(key_of(ends.from, ends.to));
  if (found == routes_.end()) return false;
  disconnect(found->second);
  return true;
}

bool RouteTable::is_listened_to(EventNode node, int event) const {
  EventNodes& nodes = execution_.nodes();
  return nodes.has_event(node, event) &&
         nodes.slot(node, nodes.schema_of(node).events[static_cast<std::size_t>(event)]).first != 0;
}

std::vector<PlacedRoute> RouteTable::all() const {
  std::vector<std::uint32_t> places;
  places.reserve(routes_.size());
  for (const auto& [key, place] : routes_) places.push_back(place);
  std::sort(places.begin(), places.end());
  std::vector<PlacedRoute> result;
  result.reserve(places.size());
  const EventNodes& nodes = execution_.nodes();
  for (const std::uint32_t place : places) {
    const Connection& one = connections_[place];
    const EventMember &from = nodes[one.source], &to = nodes[one.to];
    result.push_back({from.scene,
                      to.scene,
                      {from.id, to.id, from.schema->interfaces[one.from - from.first_slot].declaration,
                       to.schema->interfaces[one.event_in].declaration}});
  }
  return result;
}

bool RouteTable::connect_instance(SceneGraph& scene, NodeId id) {
  const Node& node = scene.node(id);
  const Prototype& prototype = *node.type->prototype;
  SceneState& state = execution_.scenes().state_of(scene);
  const EventNodes& nodes = execution_.nodes();
  for (const IsMapping& mapping : prototype.mappings) {
    if (mapping.outer->access == AccessType::field) continue;
    const std::optional<std::uint32_t> place = place_in_body(prototype, mapping.node);
    if (!place) continue;
    const NodeId inner_id = scene.nodes().id_at(node.expansion_first + *place);
    // An EXTERNPROTO declares its own interfaces, possibly fewer than the PROTO.
    const InterfaceDeclaration* outer = node.type->find(mapping.outer->name);
    if (!scene.contains(inner_id) || !outer || outer->type != mapping.inner->type) continue;
    const EventNode instance = execution_.scenes().member(state, id);
    const EventNode inner = execution_.scenes().member(state, inner_id);
    if (instance == 0 || inner == 0) return false;
    const EventSchema& outside = *nodes[instance].schema;
    const std::uint32_t outer_place = outside.find(*outer), inner_place = nodes[inner].schema->find(*mapping.inner);
    if (outer_place == EventSchema::kNone || inner_place == EventSchema::kNone) continue;
    const auto ways_down = nodes[instance].first_slot + static_cast<std::uint32_t>(outside.interfaces.size());
    if (receives(*outer) && receives(*mapping.inner) &&
        connect(instance, ways_down + outer_place, inner, inner_place, Way::down) == 0)
      return false;
    if (sends(*outer) && sends(*mapping.inner) &&
        connect(inner, nodes[inner].first_slot + inner_place, instance, outer_place, Way::up) == 0)
      return false;
    if (sends(*outer) && sends(*mapping.inner)) note_listener(inner);
  }
  return true;
}

std::uint32_t RouteTable::connect(EventNode source, std::uint32_t from, EventNode to, std::uint32_t event_in, Way way) {
  std::uint32_t made = 0;
  if (!free_connections_.empty()) {
    made = free_connections_.back();
    free_connections_.pop_back();
  } else {
    if (!execution_.budget().afford(2 * sizeof(Connection))) return 0;
    made = static_cast<std::uint32_t>(connections_.size());
    connections_.emplace_back();
  }
  EventSlot& slot = execution_.nodes().slot(from);
  EventMember& target = execution_.nodes()[to];
  connections_[made] = {0, slot.last, target.first_in, 0, source, from, to, event_in, way};
  (slot.last != 0 ? connections_[slot.last].next : slot.first) = made;
  slot.last = made;
  if (target.first_in != 0) connections_[target.first_in].previous_in = made;
  target.first_in = made;
  return made;
}

// Removes a connection. A cascade may still follow its entry, so the entry becomes free when the cascade ends.
void RouteTable::disconnect(std::uint32_t place) {
  Connection& removed = connections_[place];
  EventSlot& slot = execution_.nodes().slot(removed.from);
  EventMember& target = execution_.nodes()[removed.to];
  (removed.previous != 0 ? connections_[removed.previous].next : slot.first) = removed.next;
  (removed.next != 0 ? connections_[removed.next].previous : slot.last) = removed.previous;
  (removed.previous_in != 0 ? connections_[removed.previous_in].next_in : target.first_in) = removed.next_in;
  if (removed.next_in != 0) connections_[removed.next_in].previous_in = removed.previous_in;
  if (removed.way == Way::route) {
    routes_.erase(key_of(removed.from, target.first_slot + removed.event_in));
    ++revision_;
    execution_.budget().give_back(kRouteEntry);
  }
  removed.way = Way::removed;
  removed_connections_.push_back(place);
}

void RouteTable::disconnect_all(EventNode node) {
  EventMember& at = execution_.nodes()[node];
  const std::size_t slots = EventNodes::slots_of(*at.schema);
  for (std::size_t i = 0; i < slots; ++i)
    while (const std::uint32_t first = execution_.nodes().slot(at.first_slot + static_cast<std::uint32_t>(i)).first)
      disconnect(first);
  while (at.first_in != 0) disconnect(at.first_in);
}

void RouteTable::reuse_removed() {
  free_connections_.insert(free_connections_.end(), removed_connections_.begin(), removed_connections_.end());
  removed_connections_.clear();
}

}  // namespace gs::vrml
