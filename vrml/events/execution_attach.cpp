#include "vrml/events/execution.h"
#include "vrml/events/states.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace gs::vrml {
namespace {

// Approximate bytes per ROUTE in the route table.
constexpr std::size_t kRouteEntry = 48;

std::uint64_t key_of(std::uint32_t from, std::uint32_t to) { return std::uint64_t{from} << 32 | to; }

bool sends(const InterfaceDeclaration& declaration) {
  return declaration.access == AccessType::eventOut || declaration.access == AccessType::exposedField;
}
bool receives(const InterfaceDeclaration& declaration) {
  return declaration.access == AccessType::eventIn || declaration.access == AccessType::exposedField;
}

}  // namespace

Execution::Execution(SceneGraph& root)
    : root_(root),
      share_(root.budget(), Resource::nodes),
      placement_(root),
      pointing_(std::make_unique<Pointing>(*this)),
      states_(std::make_unique<States>()) {
  now_ = previous_ = -std::numeric_limits<double>::infinity();
  nodes_.emplace_back();
  connections_.emplace_back();
  scenes_.emplace_back(&root);
  scene_places_[&root] = 0;
  attach();
}

std::size_t Execution::scene_state(SceneGraph& scene) {
  const auto [place, fresh] = scene_places_.try_emplace(&scene, scenes_.size());
  if (!fresh) return place->second;
  if (free_scenes_.empty()) {
    scenes_.emplace_back(&scene);
  } else {
    place->second = free_scenes_.back();
    free_scenes_.pop_back();
    scenes_[place->second] = SceneState(&scene);
  }
  return place->second;
}

void Execution::attach() {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < scenes_.size(); ++i)
    if (scenes_[i].scene) order.push_back(i);
  attach_all(std::move(order));
}

void Execution::attach(SceneGraph& scene) {
  if (const auto place = scene_places_.find(&scene); place != scene_places_.end()) attach_all({place->second});
}

// Attaches scenes; nested Inlines come after the Inlines that contain them.
void Execution::attach_all(std::vector<std::size_t> order) {
  placement_.forget();
  pointing_->forget();
  for (std::size_t i = 0; i < order.size(); ++i) {
    attach_scene(order[i]);
    const SceneGraph& scene = *scenes_[order[i]].scene;
    std::vector<std::uint32_t> places;
    for (const auto& [place, content] : scene.inlines())
      if (content && !scene_places_.contains(content.get())) places.push_back(place);
    std::sort(places.begin(), places.end());
    for (const std::uint32_t place : places) order.push_back(scene_state(*scene.inlined(scene.id_at(place))));
  }
}

void Execution::attach_node(SceneState& state, NodeId id) {
  const Node& node = state.scene->node(id);
  if (node.in_prototype_body) return;
  if (node.owner != 0) {
    state.at_run_time.push_back(id);
    ++made_since_;
  }
  has_pointing_sensors_ = has_pointing_sensors_ || (node.type->behaviour && node.type->behaviour->pointing);
  if (node.type->behaviour && node.type->behaviour->initialize) (void)member(state, id);
  // New nodes fetch their URLs as on a set_url event.
  if ((node.owner != 0 || state.lives) && node.type->url_content != UrlContent::none)
    for (const InterfaceDeclaration* url : node.type->url_fields())
      if (const EventNode made = member(state, id)) mark_changed(made, url->slot);
  if (node.type->prototype || node.type->kind == NodeType::Kind::external_prototype) (void)attach_instance(state, id);
  // The body of an EXTERNPROTO is fetched as well.
  if (node.owner != 0 && !node.type->prototype && node.type->kind == NodeType::Kind::external_prototype)
    content_changed(*state.scene, id);
}

void Execution::attach_scene(std::size_t index) {
  SceneState& state = scenes_[index];
  SceneGraph& scene = *state.scene;
  for (const NodeId id : std::exchange(state.waiting, {}))
    if (scene.contains(id) && attach_instance(state, id) && state.lives) content_changed(scene, id);
  for (; state.nodes_seen <= scene.node_count(); ++state.nodes_seen) {
    const Node& node = scene.node_at(static_cast<std::uint32_t>(state.nodes_seen));
    if (!node.in_prototype_body && node.owner == 0 && !node.recycled)
      attach_node(state, scene.id_at(static_cast<std::uint32_t>(state.nodes_seen)));
  }
  for (const NodeId id : scene.take_made())
    if (scene.contains(id)) attach_node(state, id);
  std::vector<Route>& routes = scene.routes();
  for (std::size_t i = state.routes_seen; i < routes.size(); ++i) (void)add_route(scene, routes[i]);
  const auto at_run_time = [&](NodeId id) { return !scene.contains(id) || scene.node(id).owner != 0; };
  routes.erase(std::remove_if(routes.begin() + static_cast<std::ptrdiff_t>(state.routes_seen), routes.end(),
                              [&](const Route& route) { return at_run_time(route.from) || at_run_time(route.to); }),
               routes.end());
  state.routes_seen = routes.size();
  state.lives = true;
}

// Connects the interface of a PROTO instance to the nodes of its body, according to IS.
bool Execution::attach_instance(SceneState& state, NodeId id) {
  SceneGraph& scene = *state.scene;
  const Node& node = scene.node(id);
  if (node.expansion.empty() || !node.type->prototype) {
    if (node.type->kind == NodeType::Kind::external_prototype && afford(sizeof(NodeId))) state.waiting.push_back(id);
    return false;
  }
  const Prototype& prototype = *node.type->prototype;
  for (const IsMapping& mapping : prototype.mappings) {
    if (mapping.outer->access == AccessType::field) continue;
    const std::optional<std::uint32_t> place = place_in_body(prototype, mapping.node);
    if (!place) continue;
    const NodeId inner_id = scene.id_at(node.expansion_first + *place);
    // An EXTERNPROTO has its own declarations, possibly fewer.
    const InterfaceDeclaration* outer = node.type->find(mapping.outer->name);
    if (!scene.contains(inner_id) || !outer || outer->type != mapping.inner->type) continue;
    const EventNode instance = member(state, id), inner = member(state, inner_id);
    if (instance == 0 || inner == 0) return false;
    const EventSchema& outside = *nodes_[instance].schema;
    const std::uint32_t outer_place = outside.find(*outer), inner_place = nodes_[inner].schema->find(*mapping.inner);
    if (outer_place == EventSchema::kNone || inner_place == EventSchema::kNone) continue;
    const auto ways_down = nodes_[instance].first_slot + static_cast<std::uint32_t>(outside.interfaces.size());
    if (receives(*outer) && receives(*mapping.inner) &&
        connect(instance, ways_down + outer_place, inner, inner_place, Way::down) == 0)
      return false;
    if (sends(*outer) && sends(*mapping.inner) &&
        connect(inner, nodes_[inner].first_slot + inner_place, instance, outer_place, Way::up) == 0)
      return false;
  }
  return true;
}

EventSchema& Execution::schema_of(const NodeType& type) {
  std::unique_ptr<EventSchema>& schema = schemas_[&type];
  if (!schema) schema = std::make_unique<EventSchema>(type);
  return *schema;
}

EventNode Execution::member(SceneState& state, NodeId id) {
  if (state.members.size() <= id.index) {
    const std::size_t count = state.scene->node_count() + 1;
    if (!afford((count - state.members.size()) * sizeof(EventNode))) return 0;
    state.members.resize(count);
  }
  if (state.members[id.index] != 0) return state.members[id.index];
  Node& node = state.scene->node(id);
  EventSchema& schema = schema_of(*node.type);
  const std::size_t slots = schema.interfaces.size() * (schema.instance ? 2 : 1);
  // Entries left by removed nodes are already drawn from the budget.
  const auto place_of = [](auto& free, std::size_t count) -> std::optional<std::uint32_t> {
    const auto places = free.find(count);
    if (places == free.end() || places->second.empty()) return {};
    const std::uint32_t place = places->second.back();
    places->second.pop_back();
    return place;
  };
  const auto free_slots = place_of(free_slots_, slots), free_outs = place_of(free_outs_, schema.outs.size());
  constexpr std::size_t kBuffers = 2;  // factor for the spare capacity of growing vectors
  const std::size_t fresh = (free_members_.empty() ? sizeof(Member) : 0) + (free_slots ? 0 : slots * sizeof(Slot)) +
                            (free_outs ? 0 : schema.outs.size() * sizeof(FieldValue));
  if (!afford(kBuffers * fresh)) {
    if (free_slots) free_slots_[slots].push_back(*free_slots);
    if (free_outs) free_outs_[schema.outs.size()].push_back(*free_outs);
    return 0;
  }
  if (free_members_.empty()) {
    free_members_.push_back(static_cast<EventNode>(nodes_.size()));
    nodes_.emplace_back();
  }
  const EventNode made = free_members_.back();
  free_members_.pop_back();
  Member& at = nodes_[made] = {};
  at.scene = state.scene;
  at.node = &node;
  at.id = id;
  at.schema = &schema;
  at.first_slot = free_slots.value_or(static_cast<std::uint32_t>(slots_.size()));
  at.first_out = free_outs.value_or(static_cast<std::uint32_t>(out_values_.size()));
  if (!free_slots) slots_.resize(slots_.size() + slots);
  for (std::size_t i = 0; i < schema.outs.size(); ++i) {
    if (!free_outs) out_values_.emplace_back();
    out_values_[at.first_out + i] = initial_value(schema.outs[i]);
  }
  ++schema.users;
  state.members[id.index] = made;
  if (schema.behaviour && schema.behaviour->initialize) schema.behaviour->initialize(*this, made);
  return made;
}

std::uint32_t Execution::connect(EventNode source, std::uint32_t from, EventNode to, std::uint32_t event_in, Way way) {
  std::uint32_t made = 0;
  if (!free_connections_.empty()) {
    made = free_connections_.back();
    free_connections_.pop_back();
  } else {
    if (!afford(2 * sizeof(Connection))) return 0;
    made = static_cast<std::uint32_t>(connections_.size());
    connections_.emplace_back();
  }
  Slot& slot = slots_[from];
  Member& target = nodes_[to];
  connections_[made] = {0, slot.last, target.first_in, 0, source, from, to, event_in, way};
  (slot.last != 0 ? connections_[slot.last].next : slot.first) = made;
  slot.last = made;
  if (target.first_in != 0) connections_[target.first_in].previous_in = made;
  target.first_in = made;
  return made;
}

// Removes a connection. A cascade may still traverse its entry, which becomes free when the cascade ends.
void Execution::disconnect(std::uint32_t place) {
  Connection& removed = connections_[place];
  Slot& slot = slots_[removed.from];
  (removed.previous != 0 ? connections_[removed.previous].next : slot.first) = removed.next;
  (removed.next != 0 ? connections_[removed.next].previous : slot.last) = removed.previous;
  (removed.previous_in != 0 ? connections_[removed.previous_in].next_in : nodes_[removed.to].first_in) =
      removed.next_in;
  if (removed.next_in != 0) connections_[removed.next_in].previous_in = removed.previous_in;
  if (removed.way == Way::route) {
    routes_.erase(key_of(removed.from, nodes_[removed.to].first_slot + removed.event_in));
    ++routes_revision_;
    afforded_ -= kRouteEntry;
  }
  removed.way = Way::removed;
  removed_connections_.push_back(place);
}

struct Execution::Ends {
  EventNode source = 0;
  std::uint32_t from = 0, to = 0;  // slots
  EventNode target = 0;
  std::uint32_t event_in = 0;
};

bool Execution::find_ends(SceneGraph& scene, const Route& route, Ends& ends) {
  if (!scene.contains(route.from) || !scene.contains(route.to) || !route.event_out || !route.event_in) return false;
  if (route.event_out->type != route.event_in->type || !sends(*route.event_out) || !receives(*route.event_in))
    return false;
  const std::size_t state = scene_state(scene);
  const EventNode from = member(scenes_[state], route.from);
  ends.target = member(scenes_[state], route.to);
  if (from == 0 || ends.target == 0) return false;
  const std::uint32_t event_out = nodes_[from].schema->find(*route.event_out);
  ends.event_in = nodes_[ends.target].schema->find(*route.event_in);
  if (event_out == EventSchema::kNone || ends.event_in == EventSchema::kNone) return false;
  ends.source = from;
  ends.from = nodes_[from].first_slot + event_out;
  ends.to = nodes_[ends.target].first_slot + ends.event_in;
  return true;
}

bool Execution::add_route(SceneGraph& scene, const Route& route) {
  Ends ends;
  if (!find_ends(scene, route, ends) || routes_.contains(key_of(ends.from, ends.to)) || !afford(kRouteEntry))
    return false;
  const std::uint32_t made = connect(ends.source, ends.from, ends.target, ends.event_in, Way::route);
  if (made == 0) {
    afforded_ -= kRouteEntry;
    return false;
  }
  routes_.emplace(key_of(ends.from, ends.to), made);
  ++routes_revision_;
  return true;
}

std::vector<Execution::PlacedRoute> Execution::placed_routes() const {
  std::vector<std::uint32_t> places;
  places.reserve(routes_.size());
  for (const auto& [key, place] : routes_) places.push_back(place);
  std::sort(places.begin(), places.end());
  std::vector<PlacedRoute> result;
  result.reserve(places.size());
  for (const std::uint32_t place : places) {
    const Connection& one = connections_[place];
    const Member &from = nodes_[one.source], &to = nodes_[one.to];
    result.push_back({from.scene,
                      {from.id, to.id, from.schema->interfaces[one.from - from.first_slot].declaration,
                       to.schema->interfaces[one.event_in].declaration}});
  }
  return result;
}

bool Execution::remove_route(SceneGraph& scene, const Route& route) {
  Ends ends;
  if (!find_ends(scene, route, ends)) return false;
  const auto found = routes_.find(key_of(ends.from, ends.to));
  if (found == routes_.end()) return false;
  disconnect(found->second);
  return true;
}

void Execution::start(double now) {
  begin(now);
  previous_ = now_;
  started_ = starting_ = true;
  bind_first_nodes(scenes_.front(), false);
  begin_scripts();
  starting_ = false;
  drain();
}

void Execution::bind_what_came() {
  bind_first_nodes(scenes_.front(), true);
  drain();
}

// Binds the first visible nodes in file order, without Inlines (4.6.10). The standard does not say whether hidden
// children of a Switch are candidates. Other browsers skip them, and worlds use a Switch to choose their Background.
void Execution::bind_first_nodes(SceneState& state, bool of_fresh_types) {
  SceneGraph& scene = *state.scene;
  std::vector<bool> seen(scene.node_count() + 1);
  std::vector<const NodeType*> known;
  for (const Stack& stack : stacks_)
    if (of_fresh_types) known.push_back(stack.type);
  struct Place {
    const NodeId* next;
    const NodeId* end;
  };
  std::vector<Place> path{{scene.roots().begin(), scene.roots().end()}};
  while (!path.empty()) {
    if (path.back().next == path.back().end) {
      path.pop_back();
      continue;
    }
    const NodeId id = scene.resolve(*path.back().next++);
    if (!id || seen[id.index]) continue;
    seen[id.index] = true;
    const Node& node = scene.node(id);
    const bool is_known = std::find(known.begin(), known.end(), node.type) != known.end();
    if (has(node.type->role, Role::bindable) && node.type->behaviour && !is_known &&
        !(of_fresh_types && node.owner != 0)) {
      const EventNode bindable = member(state, id);
      if (bindable != 0 && stack_of(*node.type).top == 0)
        (void)node.type->behaviour->on_event(*this, bindable, kSetBind, FieldValue(true));
      nodes_[bindable].placed = nodes_[bindable].on_stack;
    }
    if (!has(node.type->role, Role::grouping)) continue;
    const InterfaceDeclaration* which = node.type->find_field("whichChoice");
    const auto* chosen = which ? std::get_if<SFInt32>(&node.values[which->slot]) : nullptr;
    for (const InterfaceDeclaration& declaration : node.type->interfaces)
      if (declaration.slot >= 0)
        if (const auto* children = std::get_if<MFNode>(&node.values[declaration.slot])) {
          const NodeId *begin = children->begin(), *end = children->end();
          if (chosen) {
            begin = *chosen < 0 || *chosen >= end - begin ? end : begin + *chosen;
            end = begin == end ? end : begin + 1;
          }
          path.push_back({begin, end});
        }
  }
}

}  // namespace gs::vrml
