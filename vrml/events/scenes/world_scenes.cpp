#include "vrml/events/world_scenes.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {

WorldScenes::WorldScenes(Execution& execution, SceneGraph& root) : execution_(execution), root_(root) {
  states_.emplace_back(&root);
  places_[&root] = 0;
}

std::size_t WorldScenes::place_of(SceneGraph& scene) {
  const auto [place, fresh] = places_.try_emplace(&scene, states_.size());
  if (!fresh) return place->second;
  if (free_places_.empty()) {
    states_.emplace_back(&scene);
  } else {
    place->second = free_places_.back();
    free_places_.pop_back();
    states_[place->second] = SceneState(&scene);
  }
  return place->second;
}

SceneState* WorldScenes::find(const SceneGraph* scene) {
  const auto place = places_.find(scene);
  return place == places_.end() ? nullptr : &states_[place->second];
}

const SceneState* WorldScenes::find(const SceneGraph* scene) const {
  const auto place = places_.find(scene);
  return place == places_.end() ? nullptr : &states_[place->second];
}

SceneGraph* WorldScenes::own(const SceneGraph& scene) {
  SceneState* const state = find(&scene);
  return state ? state->scene : nullptr;
}

EventNode WorldScenes::event_node(const SceneGraph& scene, NodeId node) {
  SceneState* const state = find(&scene);
  return state && scene.contains(node) ? member(*state, node) : 0;
}

EventNode WorldScenes::member(SceneState& state, NodeId id) {
  if (state.members.size() <= id.index) {
    const std::size_t count = state.scene->nodes().count() + 1;
    if (!execution_.budget().afford((count - state.members.size()) * sizeof(EventNode))) return 0;
    state.members.resize(count);
  }
  EventNode& entry = state.members[id.index];
  return entry != 0 ? entry : execution_.nodes().make(*state.scene, id, entry);
}

void WorldScenes::remove(const SceneGraph& scene) {
  const auto place = places_.find(&scene);
  states_[place->second] = SceneState();
  free_places_.push_back(place->second);
  places_.erase(place);
  ++removals_;
}

void WorldScenes::attach() {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (states_[i].scene) order.push_back(i);
  attach_all(std::move(order));
}

void WorldScenes::attach(SceneGraph& scene) {
  if (const auto place = places_.find(&scene); place != places_.end()) attach_all({place->second});
}

// Attaches scenes. An Inline precedes the Inlines nested in it. New nodes of a scene that lives are not yet in the
// hierarchy.
void WorldScenes::attach_all(std::vector<std::size_t> order) {
  execution_.pointing().forget();
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (!states_[order[i]].lives) execution_.placement().forget();
    execution_.routes().imports().note_scene(*states_[order[i]].scene, !states_[order[i]].lives);
    attach_scene(states_[order[i]]);
    const SceneGraph& scene = *states_[order[i]].scene;
    std::vector<std::uint32_t> inlines;
    for (const auto& [node, content] : scene.inlines().all())
      if (content && !has(content.get())) inlines.push_back(node);
    std::sort(inlines.begin(), inlines.end());
    for (const std::uint32_t node : inlines) {
      order.push_back(place_of(*scene.inlines().of(scene.nodes().id_at(node))));
      note_content(scene, scene.nodes().id_at(node));
    }
  }
  execution_.routes().imports().connect();
}

// Lets an Inline send children_changed for its new content, if another node listens.
void WorldScenes::note_content(const SceneGraph& scene, NodeId inline_node) {
  SceneState* const state = find(&scene);
  const EventNode node = state && inline_node.index < state->members.size() ? state->members[inline_node.index] : 0;
  if (node == 0) return;
  const Behaviour* const behaviour = execution_.nodes().schema_of(node).behaviour;
  if (!behaviour || !behaviour->watches_routes) return;
  execution_.nodes().state_of(node) = 0;
  execution_.timers().look_again(node);
  execution_.timers().call_at(node, execution_.now());
}

void WorldScenes::attach_node(SceneState& state, NodeId id) {
  const Node& node = state.scene->node(id);
  if (node.in_prototype_body) return;
  if (node.owner != 0) {
    state.at_run_time.push_back(id);
    execution_.lifetime().note_made();
  }
  const Behaviour* const behaviour = node.type->behaviour;
  if (behaviour && behaviour->pointing) execution_.pointing().note_sensor();
  if (behaviour && behaviour->initialize) (void)member(state, id);
  // New nodes load their URLs, as after a set_url event.
  if ((node.owner != 0 || state.lives) && node.type->url_content != UrlContent::none)
    for (const InterfaceDeclaration* url : node.type->url_fields())
      if (const EventNode made = member(state, id)) execution_.changes().mark(made, url->slot);
  const bool external = node.type->kind == NodeType::Kind::external_prototype;
  if (node.type->prototype || external) (void)attach_instance(state, id);
  // Also loads the body of an EXTERNPROTO.
  if (node.owner != 0 && !node.type->prototype && external) execution_.changes().mark_content(*state.scene, id);
}

void WorldScenes::attach_scene(SceneState& state) {
  constexpr std::size_t kBetweenLooks = 1024;  // number of nodes between two calls of EventBudget::look()
  SceneGraph& scene = *state.scene;
  EventBudget& budget = execution_.budget();
  for (const NodeId id : std::exchange(state.waiting, {}))
    if (scene.contains(id) && attach_instance(state, id) && state.lives) execution_.changes().mark_content(scene, id);
  for (; state.nodes_seen <= scene.nodes().count(); ++state.nodes_seen) {
    const Node& node = scene.nodes().at(static_cast<std::uint32_t>(state.nodes_seen));
    if (!node.in_prototype_body && node.owner == 0 && !node.recycled)
      attach_node(state, scene.nodes().id_at(static_cast<std::uint32_t>(state.nodes_seen)));
  }
  std::size_t attached = 0;
  for (const NodeId id : scene.nodes().take_made()) {
    if (++attached % kBetweenLooks == 0 && budget.look()) break;  // a world without events needs no more
    if (scene.contains(id)) attach_node(state, id);
  }
  std::vector<Route>& routes = scene.routes();
  for (std::size_t i = state.routes_seen; i < routes.size() && !budget.is_halted(); ++i)
    (void)execution_.routes().add(scene, routes[i]);
  const auto at_run_time = [&](NodeId id) { return !scene.contains(id) || scene.node(id).owner != 0; };
  routes.erase(std::remove_if(routes.begin() + static_cast<std::ptrdiff_t>(state.routes_seen), routes.end(),
                              [&](const Route& route) { return at_run_time(route.from) || at_run_time(route.to); }),
               routes.end());
  state.routes_seen = routes.size();
  state.lives = true;
}

// Connects an instance to its body. An instance of an EXTERNPROTO without a body is listed until the body is loaded.
bool WorldScenes::attach_instance(SceneState& state, NodeId id) {
  const Node& node = state.scene->node(id);
  if (!node.expansion.empty() && node.type->prototype) return execution_.routes().connect_instance(*state.scene, id);
  if (node.type->kind == NodeType::Kind::external_prototype && execution_.budget().afford(sizeof(NodeId)))
    state.waiting.push_back(id);
  return false;
}

}  // namespace gs::vrml
