#include "vrml/event_model/parent_index.h"

#include "vrml/event_model/behaviour.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kDeepest = 100'000;

bool is_group(const Node& node) { return has(node.type->role, Role::grouping); }

bool is_mover(const Node& node) {
  const Behaviour* behaviour = node.type->behaviour;
  return is_group(node) && behaviour && (behaviour->parent_from_local || behaviour->parent_from_facing);
}

}  // namespace

std::uint32_t ParentIndex::scene_of(const SceneGraph& graph) {
  const auto [number, fresh] = numbers_.try_emplace(&graph, static_cast<std::uint32_t>(scenes_.size()));
  if (fresh) {
    scenes_.emplace_back();
    scenes_.back().graph = &graph;
  }
  make_room(scenes_[number->second]);
  return number->second;
}

NodePlace ParentIndex::node_at(Place place) const {
  const SceneGraph& graph = *scenes_[place.scene].graph;
  return {&graph, place.node == 0 ? NodeId{} : graph.nodes().id_at(place.node)};
}

void ParentIndex::make_room(Scene& scene) {
  const std::size_t count = scene.graph->nodes().count() + 1;
  if (scene.known.size() >= count) return;
  scene.known.resize(count);
  scene.first_as_parent.resize(count);
  scene.first_as_child.resize(count);
}

void ParentIndex::build() {
  scenes_.clear();
  numbers_.clear();
  visits_ = 0;
  take_in({scene_of(root_), 0});
}

// Writes the children of a node to fresh_, in order. A child that occurs twice is listed twice.
void ParentIndex::list_children(Place place) {
  fresh_.clear();
  const SceneGraph& graph = *scenes_[place.scene].graph;
  const auto add = [&](const MFNode& children) {
    for (const NodeId child : children) {
      ++visits_;
      const NodeId id = graph.resolve(child);
      if (!id) continue;
      const Node& node = graph.node(id);
      if (is_group(node) || node.type->behaviour) fresh_.push_back(id.index);
    }
  };
  if (place.node == 0) return add(graph.roots());
  const Node& node = graph.nodes().at(place.node);
  for (const InterfaceDeclaration& field : node.type->interfaces)
    if (field.type == FieldType::MFNode && field.slot >= 0 && !field.lists)
      add(*std::get_if<MFNode>(&node.values[field.slot]));
  if (const GeoTiles* const tiles = graph.inlines().tiles_of(graph.nodes().id_at(place.node))) {
    add(tiles->root);
    add(tiles->children);
  }
}

// Indexes a node and all nodes below it, up to nodes that are known.
void ParentIndex::take_in(Place top) {
  std::vector<Place> waiting{top};
  while (!waiting.empty()) {
    const Place place = waiting.back();
    waiting.pop_back();
    if (scenes_[place.scene].known[place.node]) continue;
    scenes_[place.scene].known[place.node] = true;
    list_children(place);
    Scene& scene = scenes_[place.scene];
    std::uint32_t last = 0;
    for (const std::uint32_t child : fresh_) {
      last = link(scene, place.node, child, last);
      if (!scene.known[child] && is_group(scene.graph->nodes().at(child))) waiting.push_back({place.scene, child});
    }
    const SceneGraph* content =
        place.node == 0 ? nullptr : scene.graph->inlines().of(scene.graph->nodes().id_at(place.node));
    if (!content) continue;
    const std::uint32_t inside = scene_of(*content);
    scenes_[inside].holders.push_back(place);
    waiting.push_back({inside, 0});
  }
}

// Adds an edge behind the edge `after` of the parent; 0 means at the front. The caller keeps positions in order.
std::uint32_t ParentIndex::link(Scene& scene, std::uint32_t parent, std::uint32_t child, std::uint32_t after) {
  auto made = static_cast<std::uint32_t>(scene.edges.size());
  if (scene.free_edges.empty()) {
    scene.edges.emplace_back();
  } else {
    made = scene.free_edges.back();
    scene.free_edges.pop_back();
  }
  Edge& edge = scene.edges[made];
  edge.parent = parent;
  edge.child = child;
  std::uint32_t& next = after == 0 ? scene.first_as_parent[parent] : scene.edges[after].next_of_parent;
  edge.next_of_parent = std::exchange(next, made);
  edge.position = after == 0 ? 0 : scene.edges[after].position + 1;
  edge.previous_of_child = 0;
  edge.next_of_child = std::exchange(scene.first_as_child[child], made);
  if (edge.next_of_child != 0) scene.edges[edge.next_of_child].previous_of_child = made;
  return made;
}

// Removes an edge. `before` is the previous edge of its parent; 0 means none.
void ParentIndex::unlink(Scene& scene, std::uint32_t edge, std::uint32_t before) {
  Edge& gone = scene.edges[edge];
  (before == 0 ? scene.first_as_parent[gone.parent] : scene.edges[before].next_of_parent) = gone.next_of_parent;
  (gone.previous_of_child == 0 ? scene.first_as_child[gone.child] : scene.edges[gone.previous_of_child].next_of_child) =
      gone.next_of_child;
  if (gone.next_of_child != 0) scene.edges[gone.next_of_child].previous_of_child = gone.previous_of_child;
  gone = {};
  scene.free_edges.push_back(edge);
}

bool ParentIndex::update(const SceneGraph& graph, NodeId node, std::vector<NodePlace>& moved) {
  const auto number = numbers_.find(&graph);
  if (number == numbers_.end()) return false;
  const Place place{number->second, node.index};
  make_room(scenes_[place.scene]);
  if (!scenes_[place.scene].known[place.node]) return false;
  visits_ = 0;
  list_children(place);
  Scene& scene = scenes_[place.scene];
  old_.clear();
  for (std::uint32_t edge = scene.first_as_parent[node.index]; edge != 0; edge = scene.edges[edge].next_of_parent)
    old_.push_back(edge);
  const auto same = [&](std::size_t i, std::size_t k) { return scene.edges[old_[i]].child == fresh_[k]; };
  const std::size_t shorter = std::min(old_.size(), fresh_.size());
  std::size_t first = 0, behind = 0;  // lengths of the equal parts at the front and at the end
  while (first < shorter && same(first, first)) ++first;
  while (first + behind < shorter && same(old_.size() - 1 - behind, fresh_.size() - 1 - behind)) ++behind;
  if (old_.size() == first + behind && fresh_.size() == first + behind) return false;
  const std::uint32_t before = first == 0 ? 0 : old_[first - 1];
  for (std::size_t i = first; i < old_.size() - behind; ++i) {
    const std::uint32_t child = scene.edges[old_[i]].child;
    if (scene.graph->contains(scene.graph->nodes().id_at(child))) moved.push_back(node_at({place.scene, child}));
    unlink(scene, old_[i], before);
  }
  std::uint32_t last = before;
  for (std::size_t i = first; i < fresh_.size() - behind; ++i) {
    last = link(scene, place.node, fresh_[i], last);
    moved.push_back(node_at({place.scene, fresh_[i]}));
  }
  for (std::size_t i = old_.size() - behind; last != before && i < old_.size(); ++i) {
    scene.edges[old_[i]].position = scene.edges[last].position + 1;
    last = old_[i];
  }
  const std::vector<std::uint32_t> fresh(fresh_.begin() + static_cast<std::ptrdiff_t>(first),
                                         fresh_.end() - static_cast<std::ptrdiff_t>(behind));
  for (const std::uint32_t child : fresh)
    if (is_group(graph.nodes().at(child))) take_in({place.scene, child});
  return true;
}

bool ParentIndex::remove(const SceneGraph& graph, NodeId node) {
  const auto number = numbers_.find(&graph);
  if (number == numbers_.end() || node.index >= scenes_[number->second].known.size()) return false;
  Scene& scene = scenes_[number->second];
  while (scene.first_as_parent[node.index] != 0) unlink(scene, scene.first_as_parent[node.index], 0);
  scene.known[node.index] = false;
  const bool had_parent = scene.first_as_child[node.index] != 0;
  while (const std::uint32_t edge = scene.first_as_child[node.index]) {
    std::uint32_t before = 0;
    for (std::uint32_t i = scene.first_as_parent[scene.edges[edge].parent]; i != edge;
         i = scene.edges[i].next_of_parent)
      before = i;
    unlink(scene, edge, before);
  }
  return had_parent;
}

// Follows the parents of a node that has one instance. Returns false if a node on the way has several parents or if the
// way is long; then `paths` is undefined.
bool ParentIndex::walk_up(Place place, std::vector<Path>& paths) const {
  constexpr int kMaxSteps = 1000;
  paths.clear();
  Path movers;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Scene& scene = scenes_[place.scene];
    if (place.node == 0) {
      if (place.scene == 0) {
        std::reverse(movers.begin(), movers.end());
        paths.push_back(std::move(movers));
        return scene.holders.empty();
      }
      if (scene.holders.size() != 1) return scene.holders.empty();
      place = scene.holders.front();
    } else {
      const std::uint32_t edge = scene.first_as_child[place.node];
      if (edge == 0) return true;  // not in the hierarchy
      if (scene.edges[edge].next_of_child != 0) return false;
      place.node = scene.edges[edge].parent;
    }
    if (place.node == 0) continue;
    const NodePlace at = node_at(place);
    if (is_mover(at.scene->node(at.node))) movers.push_back(at);
  }
  return false;
}

// Collects the relations between all ancestors of a node. Returns false if the root is not among them.
bool ParentIndex::climb(Place place, Downs& downs) const {
  std::vector<Place> waiting{place};
  std::unordered_set<std::uint64_t> seen{key_of(place)};
  bool meets_root = false;
  while (!waiting.empty()) {
    const Place child = waiting.back();
    waiting.pop_back();
    const Scene& scene = scenes_[child.scene];
    const auto add = [&](Place parent, std::uint32_t position) {
      downs[key_of(parent)].push_back({key_of(child), position});
      if (seen.insert(key_of(parent)).second) waiting.push_back(parent);
    };
    if (child == Place{}) meets_root = true;
    if (child.node == 0) {
      for (const Place& holder : scene.holders) add(holder, 0);
    } else {
      for (std::uint32_t i = scene.first_as_child[child.node]; i != 0; i = scene.edges[i].next_of_child)
        add({child.scene, scene.edges[i].parent}, scene.edges[i].position);
    }
  }
  for (auto& [parent, steps] : downs)
    std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.position < b.position; });
  return meets_root;
}

// Searches from the root, only along ancestors of the target. A path contains no node twice.
bool ParentIndex::descend(Place target, const Downs& downs, std::size_t max_paths, std::vector<Path>& paths) const {
  struct Open {
    std::uint64_t key;
    const std::vector<Step>* steps;
    std::size_t next;
    bool mover;
  };
  const auto top = downs.find(key_of({}));
  if (top == downs.end()) return true;
  std::vector<Open> path{{top->first, &top->second, 0, false}};
  std::unordered_set<std::uint64_t> on_path{top->first};
  Path movers;
  std::size_t visits = 0;
  while (!path.empty() && paths.size() < max_paths) {
    Open& open = path.back();
    if (open.next >= open.steps->size()) {
      on_path.erase(open.key);
      if (open.mover) movers.pop_back();
      path.pop_back();
      continue;
    }
    if (++visits > root_.limits().visits) return false;
    const std::uint64_t key = (*open.steps)[open.next++].key;
    if (on_path.contains(key) || path.size() >= kDeepest) continue;
    if (place_at(key) == target) paths.push_back(movers);
    const auto below = downs.find(key);
    if (below == downs.end()) continue;
    const NodePlace at = node_at(place_at(key));
    const bool mover = at.node && is_mover(at.scene->node(at.node));
    if (mover) movers.push_back(at);
    on_path.insert(key);
    path.push_back({key, &below->second, 0, mover});
  }
  return true;
}

bool ParentIndex::find_paths(const SceneGraph& graph, NodeId node, std::size_t max_paths, std::vector<Path>& paths) {
  paths.clear();
  const auto number = numbers_.find(&graph);
  if (number == numbers_.end() || node.index >= scenes_[number->second].known.size()) return true;
  const Place place{number->second, node.index};
  if (walk_up(place, paths)) return true;
  paths.clear();
  Downs downs;
  return !climb(place, downs) || descend(place, downs, max_paths, paths);
}

bool ParentIndex::each_below(const NodePlace& top, std::size_t max_nodes,
                             const std::function<void(const NodePlace&)>& visit) const {
  const auto number = numbers_.find(top.scene);
  if (number == numbers_.end()) return true;
  std::vector<Place> waiting{{number->second, top.node.index}};
  std::unordered_set<std::uint64_t> seen{key_of(waiting.front())};
  const auto add = [&](Place place) {
    if (seen.insert(key_of(place)).second) waiting.push_back(place);
  };
  while (!waiting.empty()) {
    if (seen.size() > max_nodes) return false;
    const Place place = waiting.back();
    waiting.pop_back();
    const Scene& scene = scenes_[place.scene];
    if (place.node >= scene.known.size()) continue;
    const NodePlace at = node_at(place);
    if (at.node) visit(at);
    for (std::uint32_t i = scene.first_as_parent[place.node]; i != 0; i = scene.edges[i].next_of_parent)
      add({place.scene, scene.edges[i].child});
    const SceneGraph* content = at.node ? at.scene->inlines().of(at.node) : nullptr;
    if (const auto inside = content ? numbers_.find(content) : numbers_.end(); inside != numbers_.end())
      add({inside->second, 0});
  }
  return true;
}

}  // namespace gs::vrml
