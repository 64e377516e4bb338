#include "vrml/events/execution.h"
#include "vrml/events/states.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gs::vrml {
namespace {

// What a ROUTE costs in the table of them, about.
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
  scenes_.push_back({&root, {}, 1, 0, {}, true});
  scene_places_[&root] = 0;
  attach();
}

std::size_t Execution::scene_state(SceneGraph& scene) {
  const auto [place, fresh] = scene_places_.try_emplace(&scene, scenes_.size());
  if (fresh) scenes_.push_back({&scene, {}, 1, 0, {}, false});
  return place->second;
}

void Execution::attach() {
  placement_.forget();
  pointing_->forget();
  // Inlines inside Inlines stand behind those that hold them.
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    attach_scene(i);
    std::vector<std::uint32_t> places;
    for (const auto& [place, content] : scenes_[i].scene->inlines())
      if (content && !scene_places_.contains(content.get())) places.push_back(place);
    std::sort(places.begin(), places.end());
    for (const std::uint32_t place : places)
      (void)scene_state(*scenes_[i].scene->inlined(scenes_[i].scene->id_at(place)));
  }
}

void Execution::attach_scene(std::size_t index) {
  SceneState& state = scenes_[index];
  SceneGraph& scene = *state.scene;
  for (const NodeId id : std::exchange(state.waiting, {})) (void)attach_instance(state, id);
  for (; state.nodes_seen <= scene.node_count(); ++state.nodes_seen) {
    const NodeId id = scene.id_at(static_cast<std::uint32_t>(state.nodes_seen));
    const Node& node = scene.node(id);
    if (node.in_prototype_body) continue;
    has_pointing_sensors_ = has_pointing_sensors_ || (node.type->behaviour && node.type->behaviour->pointing);
    if (node.type->behaviour && node.type->behaviour->initialize) (void)member(state, id);
    if (node.type->prototype || node.type->kind == NodeType::Kind::external_prototype) (void)attach_instance(state, id);
  }
  for (; state.routes_seen < scene.routes().size(); ++state.routes_seen)
    (void)add_route(scene, scene.routes()[state.routes_seen]);
}

// The ways between the interface of a PROTO instance and the nodes of its body, as IS says.
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
    const auto place = std::lower_bound(prototype.nodes.begin(), prototype.nodes.end(), mapping.node,
                                        [](NodeId a, NodeId b) { return a.index < b.index; });
    if (place == prototype.nodes.end() || *place != mapping.node) continue;
    const NodeId inner_id =
        scene.id_at(node.expansion_first + static_cast<std::uint32_t>(place - prototype.nodes.begin()));
    // An EXTERNPROTO has declarations of its own, maybe fewer.
    const InterfaceDeclaration* outer = node.type->find(mapping.outer->name);
    if (!scene.contains(inner_id) || !outer || outer->type != mapping.inner->type) continue;
    const EventNode instance = member(state, id), inner = member(state, inner_id);
    if (instance == 0 || inner == 0) return false;
    const EventSchema& outside = *nodes_[instance].schema;
    const std::uint32_t outer_place = outside.find(*outer), inner_place = nodes_[inner].schema->find(*mapping.inner);
    if (outer_place == EventSchema::kNone || inner_place == EventSchema::kNone) continue;
    const auto ways_down = nodes_[instance].first_slot + static_cast<std::uint32_t>(outside.interfaces.size());
    if (receives(*outer) && receives(*mapping.inner) &&
        connect(ways_down + outer_place, inner, inner_place, Way::down) == 0)
      return false;
    if (sends(*outer) && sends(*mapping.inner) &&
        connect(nodes_[inner].first_slot + inner_place, instance, outer_place, Way::up) == 0)
      return false;
  }
  return true;
}

const EventSchema& Execution::schema_of(const NodeType& type) {
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
  const EventSchema& schema = schema_of(*node.type);
  const std::size_t slots = schema.interfaces.size() * (schema.instance ? 2 : 1);
  constexpr std::size_t kBuffers = 2;  // vectors have about so much room as they grow
  if (!afford(kBuffers * (sizeof(Member) + slots * sizeof(Slot) + schema.outs.size() * sizeof(FieldValue)))) return 0;
  const auto made = static_cast<EventNode>(nodes_.size());
  Member& at = nodes_.emplace_back();
  at.scene = state.scene;
  at.node = &node;
  at.id = id;
  at.schema = &schema;
  at.first_slot = static_cast<std::uint32_t>(slots_.size());
  at.first_out = static_cast<std::uint32_t>(out_values_.size());
  slots_.resize(slots_.size() + slots);
  for (const FieldType type : schema.outs) out_values_.push_back(initial_value(type));
  state.members[id.index] = made;
  if (schema.behaviour && schema.behaviour->initialize) schema.behaviour->initialize(*this, made);
  return made;
}

std::uint32_t Execution::connect(std::uint32_t from, EventNode to, std::uint32_t event_in, Way way) {
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
  connections_[made] = {0, slot.last, from, to, event_in, way};
  if (slot.last != 0) {
    connections_[slot.last].next = made;
  } else {
    slot.first = made;
  }
  slot.last = made;
  return made;
}

struct Execution::Ends {
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
  ends.from = nodes_[from].first_slot + event_out;
  ends.to = nodes_[ends.target].first_slot + ends.event_in;
  return true;
}

bool Execution::add_route(SceneGraph& scene, const Route& route) {
  Ends ends;
  if (!find_ends(scene, route, ends) || routes_.contains(key_of(ends.from, ends.to)) || !afford(kRouteEntry))
    return false;
  const std::uint32_t made = connect(ends.from, ends.target, ends.event_in, Way::route);
  if (made == 0) return false;
  routes_.emplace(key_of(ends.from, ends.to), made);
  return true;
}

bool Execution::remove_route(SceneGraph& scene, const Route& route) {
  Ends ends;
  if (!find_ends(scene, route, ends)) return false;
  const auto found = routes_.find(key_of(ends.from, ends.to));
  if (found == routes_.end()) return false;
  const std::uint32_t place = found->second;
  routes_.erase(found);
  Connection& removed = connections_[place];
  Slot& slot = slots_[removed.from];
  (removed.previous != 0 ? connections_[removed.previous].next : slot.first) = removed.next;
  (removed.next != 0 ? connections_[removed.next].previous : slot.last) = removed.previous;
  // A cascade may stand on it; it can be used again when that is over.
  removed.way = Way::removed;
  removed_connections_.push_back(place);
  return true;
}

void Execution::start(double now) {
  begin(now);
  previous_ = now_;
  bind_first_nodes();
  drain();
}

// In the order of the file, through what is shown, without Inlines (4.6.10).
void Execution::bind_first_nodes() {
  SceneState& state = scenes_.front();
  SceneGraph& scene = *state.scene;
  std::vector<bool> seen(scene.node_count() + 1);
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
    if (has(node.type->role, Role::bindable) && node.type->behaviour) {
      const EventNode bindable = member(state, id);
      if (bindable != 0 && stack_of(*node.type).top == 0)
        (void)node.type->behaviour->on_event(*this, bindable, kSetBind, FieldValue(true));
      nodes_[bindable].placed = nodes_[bindable].on_stack;
    }
    if (!has(node.type->role, Role::grouping)) continue;
    for (const InterfaceDeclaration& declaration : node.type->interfaces)
      if (declaration.slot >= 0)
        if (const auto* children = std::get_if<MFNode>(&node.values[declaration.slot]))
          path.push_back({children->begin(), children->end()});
  }
}

}  // namespace gs::vrml
