#include "vrml/events/node_lifetime.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

// Removal of run-time nodes, of Inlines and of whole worlds.
namespace gs::vrml {
namespace {

constexpr std::size_t kFewNodes = 256;  // minimum number of new run-time nodes for which a search for unheld nodes pays
// Maximum number of fields and nodes that a search visits per run-time node.
constexpr std::size_t kLooksPerNode = 16;
constexpr std::size_t kBetweenMarks = 4096;  // number of marked nodes between two calls of EventBudget::look()

bool is_script(const Node& node) { return node.type->kind == NodeType::Kind::script; }

}  // namespace

void NodeLifetime::note_referring(EventNode node) {
  if (!std::exchange(execution_.nodes()[node].refers, true)) referring_.push_back(node);
}

// Search that marks the held nodes of a scene. Skips nodes of the file as long as they are held. Such nodes refer to
// run-time nodes only after events, and referring_ lists the nodes that do.
class NodeLifetime::Marking {
 public:
  Marking(NodeLifetime& lifetime, SceneState& state)
      : lifetime_(lifetime),
        nodes_(lifetime.execution_.nodes()),
        routes_(lifetime.execution_.routes()),
        state_(state),
        scene_(*state.scene),
        marked_(scene_.nodes().count() + 1) {}

  /// Returns the nodes that are not held.
  std::vector<NodeId> find_unheld() {
    mark_held();
    std::size_t followed = 0;
    while (!waiting_.empty()) {
      const NodeId id = waiting_.back();
      waiting_.pop_back();
      follow(id);
      if (++followed % kBetweenMarks == 0 && lifetime_.execution_.budget().look()) return {};
    }
    std::vector<NodeId> unheld;
    const auto look = [&](NodeId id) {
      if (scene_.contains(id) && !marked_[id.index]) unheld.push_back(id);
    };
    if (state_.files_hold) {
      for (const NodeId id : state_.at_run_time) look(id);
    } else {
      for (std::uint32_t i = 1; i <= scene_.nodes().count(); ++i)
        if (!scene_.nodes().at(i).in_prototype_body) look(scene_.nodes().id_at(i));
    }
    return unheld;
  }
  [[nodiscard]] std::size_t looks() const { return looks_; }

 private:
  [[nodiscard]] bool of_file(const Node& node) const { return state_.files_hold && node.owner == 0; }

  void mark(NodeId id) {
    ++looks_;
    if (!scene_.contains(id) || marked_[id.index] || of_file(scene_.node(id))) return;
    marked_[id.index] = true;
    waiting_.push_back(id);
  }

  void mark(const FieldValue& value) {
    if (const auto* node = std::get_if<SFNode>(&value)) mark(*node);
    if (const auto* nodes = std::get_if<MFNode>(&value))
      for (const NodeId node : *nodes) mark(node);
  }

  void mark_values(NodeId id, EventNode member) {
    const Node& node = scene_.node(id);
    for (std::size_t i = 0; i < node.type->defaults.size(); ++i) mark(node.values[i]);
    if (const GeoTiles* const tiles = scene_.inlines().tiles_of(id)) {
      for (const NodeId tile : tiles->root) mark(tile);
      for (const NodeId tile : tiles->children) mark(tile);
    }
    if (member == 0) return;
    for (std::size_t i = 0; i < nodes_.schema_of(member).outs.size(); ++i) mark(nodes_.out_value(member, i));
  }

  template <class Visit>
  void each_target(const EventMember& at, const Visit& visit) {
    const auto slots = static_cast<std::uint32_t>(EventNodes::slots_of(*at.schema));
    for (std::uint32_t i = 0; i < slots; ++i)
      for (auto c = nodes_.slot(at.first_slot + i).first; c != 0; c = routes_.connection(c).next)
        visit(nodes_[routes_.connection(c).to]);
  }
  template <class Visit>
  void each_source(const EventMember& at, const Visit& visit) {
    for (auto c = at.first_in; c != 0; c = routes_.connection(c).next_in) visit(nodes_[routes_.connection(c).source]);
  }

  void mark_held() {
    if (const auto held = lifetime_.held_.find(&scene_); held != lifetime_.held_.end())
      for (const auto& [index, count] : held->second) mark(scene_.nodes().id_at(index));
    if (!state_.files_hold) return mark(FieldValue(scene_.roots()));
    for (const EventNode member : lifetime_.referring_)
      if (const EventMember& at = nodes_[member]; at.scene == &scene_ && of_file(*at.node)) mark_values(at.id, member);
    // Marks nodes that are held through ROUTEs to or from nodes of the file.
    for (const NodeId id : state_.at_run_time) {
      const EventNode member = scene_.contains(id) ? state_.member_of(id) : 0;
      if (member == 0) continue;
      const EventMember& at = nodes_[member];
      bool held = false;
      each_target(at, [&](const EventMember& target) { held = held || of_file(*target.node); });
      if (is_script(*at.node))
        each_source(at, [&](const EventMember& source) { held = held || of_file(*source.node); });
      if (held) mark(id);
    }
  }

  void follow(NodeId id) {
    const Node& node = scene_.node(id);
    const EventNode member = state_.member_of(id);
    mark_values(id, member);
    for (const NodeId inner : node.expansion) mark(inner);
    if (node.expansion_first != 0 && !node.in_prototype_body)
      for (std::uint32_t i = 0; i < node.type->prototype->nodes.size(); ++i)
        mark(scene_.nodes().id_at(node.expansion_first + i));
    if (node.instance != 0) mark(scene_.nodes().id_at(node.instance));
    // Marks default values, which future instances may get.
    if (marked_texts_.insert(node.owner).second && node.owner != 0)
      for (const auto& type : scene_.texts().at(node.owner).types())
        for (const FieldValue& value : type->defaults) mark(value);
    if (member == 0) return;
    const EventMember& at = nodes_[member];
    each_source(at, [&](const EventMember& source) { mark(source.id); });
    each_target(at, [&](const EventMember& target) {
      if (is_script(*target.node)) mark(target.id);
    });
  }

  NodeLifetime& lifetime_;
  EventNodes& nodes_;
  const RouteTable& routes_;
  SceneState& state_;
  const SceneGraph& scene_;
  std::vector<bool> marked_;
  std::vector<NodeId> waiting_;
  std::unordered_set<std::uint32_t> marked_texts_;
  std::size_t looks_ = 0;
};

void NodeLifetime::hold(const SceneGraph& scene, NodeId node) {
  if (scene.contains(node)) ++held_[&scene][node.index];
}

void NodeLifetime::release(const SceneGraph& scene, NodeId node) {
  const auto held = held_.find(&scene);
  if (held == held_.end() || !scene.contains(node)) return;
  const auto count = held->second.find(node.index);
  if (count != held->second.end() && --count->second == 0) held->second.erase(count);
}

// Searches only after many nodes were made, so that the cost per node stays constant.
void NodeLifetime::end_cascade() {
  if (execution_.budget().is_halted()) return;
  // A world that replaces itself at once replaces itself only once per timestamp.
  if (next_world_ && replaced_at_ != execution_.cascade().stamp()) do_replace_world();
  if (!removing_ && made_since_ >= std::max(kFewNodes, next_removal_)) (void)remove_unheld();
}

std::size_t NodeLifetime::remove_unheld() {
  if (std::exchange(removing_, true)) return 0;
  std::size_t removed = 0, looks = 0, left = 0;
  std::deque<SceneState>& states = execution_.scenes().states();
  for (std::size_t i = 0; i < states.size(); ++i) {
    SceneState& state = states[i];
    if (!state.scene || (state.files_hold && state.at_run_time.empty())) continue;
    Marking marking(*this, state);
    const std::vector<NodeId> unheld = marking.find_unheld();
    looks += marking.looks();
    removed += unheld.size();
    if (!unheld.empty()) remove_nodes(state, unheld);
    left += state.at_run_time.size();
  }
  made_since_ = 0;
  next_removal_ = std::max(left, looks / kLooksPerNode);
  removing_ = false;
  return removed;
}

void NodeLifetime::remove_nodes(SceneState& state, const std::vector<NodeId>& nodes) {
  SceneGraph& scene = *state.scene;
  std::vector<EventNode> members;
  for (const NodeId id : nodes)
    if (const EventNode member = state.member_of(id)) members.push_back(member);
  execution_.scripts().end(members);
  // Unbinds the nodes as set_bind FALSE does (4.6.10). The next nodes on the stacks send isBound.
  for (const NodeId id : nodes)
    if (const EventNode member = state.member_of(id); member != 0 && execution_.nodes()[member].on_stack)
      execution_.stacks().unbind(member);
  execution_.cascade().drain();
  for (const NodeId id : nodes) {
    if (observer_) observer_(scene, id);
    if (SceneGraph* const content = scene.inlines().of(id)) remove_scene(*content);
    if (const EventNode member = state.member_of(id)) remove_member(member);
    execution_.placement().remove(scene, id);
  }
  scene.remove(nodes);
  const auto is_gone = [&](NodeId id) { return !scene.contains(id); };
  std::erase_if(state.at_run_time, is_gone);
  std::erase_if(state.waiting, is_gone);
  execution_.pointing().forget();
  forget_removed();
}

void NodeLifetime::remove_member(EventNode node) {
  execution_.routes().disconnect_all(node);
  EventMember& at = execution_.nodes()[node];
  if (at.on_stack) execution_.stacks().bind(node, false);
  if (const Behaviour* behaviour = at.schema->behaviour) {
    if (behaviour->pointing) execution_.pointing().remove(node);
    if (behaviour->on_remove) behaviour->on_remove(execution_, node);
  }
  execution_.timers().remove(node);
  execution_.placement().remove(*at.scene, at.id);
  execution_.scenes().find(at.scene)->members[at.id.index] = 0;
  execution_.nodes().remove(node);
}

void NodeLifetime::remove_scene(SceneGraph& scene) {
  execution_.placement().forget();
  std::vector<SceneGraph*> scenes{&scene};
  for (std::size_t i = 0; i < scenes.size(); ++i)
    for (const auto& [place, content] : scenes[i]->inlines().all())
      if (content) scenes.push_back(content.get());
  for (SceneGraph* const one : scenes) {
    const SceneState* const state = execution_.scenes().find(one);
    if (!state) continue;
    if (observer_) observer_(*one, {});
    const std::vector<EventNode> members = state->members;
    for (const EventNode member : members)
      if (member != 0) remove_member(member);
    execution_.scenes().remove(*one);
    held_.erase(one);
    roots_.erase(one);
    if (next_world_ && next_world_->scene == one) next_world_.reset();
  }
}

void NodeLifetime::remove_content(SceneGraph& scene, NodeId inline_node) {
  SceneGraph* const content = scene.contains(inline_node) ? scene.inlines().of(inline_node) : nullptr;
  if (!content || !execution_.scenes().has(&scene)) return;
  const bool was_removing = std::exchange(removing_, true);
  for (const EventNode node : execution_.stacks().nodes()) {
    const SceneGraph* inside = execution_.nodes()[node].scene;
    // Also removes the nodes of nested Inlines.
    std::vector<const SceneGraph*> scenes{content};
    for (std::size_t i = 0; i < scenes.size() && inside; ++i) {
      if (scenes[i] == inside) {
        execution_.stacks().unbind(node);
        break;
      }
      for (const auto& [place, inner] : scenes[i]->inlines().all())
        if (inner) scenes.push_back(inner.get());
    }
  }
  std::vector<const SceneGraph*> leaving{content};
  for (std::size_t i = 0; i < leaving.size(); ++i) {
    if (const SceneState* const state = execution_.scenes().find(leaving[i])) execution_.scripts().end(state->members);
    for (const auto& [place, inner] : leaving[i]->inlines().all())
      if (inner) leaving.push_back(inner.get());
  }
  execution_.cascade().drain();
  remove_scene(*content);
  scene.inlines().attach(inline_node, nullptr);
  execution_.placement().forget();
  execution_.pointing().forget();
  forget_removed();
  removing_ = was_removing;
  execution_.changes().mark_content(scene, inline_node);
}

// Discards removed nodes so that their records can be used again. Call it while no cascade is running.
void NodeLifetime::forget_removed() {
  execution_.routes().reuse_removed();
  execution_.timers().forget_removed();
  std::erase_if(referring_, [&](EventNode node) { return execution_.nodes().is_removed(node); });
  execution_.scripts().forget_removed();
  execution_.changes().forget_removed();
  execution_.pointing().forget_removed();
  execution_.nodes().reuse_removed();
}

// ---- replaceWorld

bool NodeLifetime::replace_world(SceneGraph& scene, const MFNode& nodes) {
  if (!execution_.scenes().has(&scene)) return false;
  for (const NodeId id : nodes)
    if (!scene.contains(id)) return false;
  for (const NodeId id : nodes) hold(scene, id);
  if (next_world_)
    for (const NodeId id : next_world_->nodes) release(*next_world_->scene, id);
  next_world_ = NextWorld{&scene, nodes};
  return true;
}

bool NodeLifetime::set_roots(SceneGraph& scene, const MFNode& nodes) {
  if (!execution_.scenes().has(&scene)) return false;
  for (const NodeId id : nodes)
    if (!scene.contains(id)) return false;
  for (const NodeId id : nodes) hold(scene, id);
  const MFNode before = std::exchange(roots_[&scene], nodes);
  for (const NodeId id : before) release(scene, id);
  scene.set_roots(nodes);
  execution_.placement().forget();
  ++replaced_;
  return true;
}

bool NodeLifetime::replace_world(const MFNode& nodes) { return replace_world(execution_.scenes().root(), nodes); }

// Moves the scene's content into the root as an Inline, which becomes the only content of the root.
bool NodeLifetime::move_to_root(SceneGraph& scene) {
  SceneGraph& root = execution_.scenes().root();
  std::shared_ptr<SceneGraph> content;
  for (const SceneState& state : execution_.scenes().states()) {
    if (!state.scene) continue;
    for (const auto& [place, inlined] : state.scene->inlines().all())
      if (inlined.get() == &scene) content = inlined;
    if (!content) continue;
    std::vector<NodeId> holders;
    for (const auto& [place, inlined] : state.scene->inlines().all())
      if (inlined == content) holders.push_back(state.scene->nodes().id_at(place));
    for (const NodeId holder : holders) state.scene->inlines().attach(holder, nullptr);
    break;
  }
  const NodeId shown = content ? root.create(built_in_node_type(NodeKind::inline_node)) : NodeId{};
  if (!shown) return false;
  root.set_roots({shown});
  root.inlines().attach(shown, std::move(content));
  return true;
}

void NodeLifetime::do_replace_world() {
  if (removing_) return;
  replaced_at_ = execution_.cascade().stamp();
  const NextWorld next = *std::exchange(next_world_, std::nullopt);
  WorldScenes& scenes = execution_.scenes();
  SceneGraph& root = scenes.root();
  const bool is_root = next.scene == &root;
  const bool has_room = is_root || move_to_root(*next.scene);
  if (has_room) next.scene->set_roots(next.nodes);
  execution_.placement().forget();
  for (const auto& [scene, nodes] : std::exchange(roots_, {}))
    for (const NodeId id : nodes) release(*scene, id);
  for (const NodeId id : next.nodes) release(*next.scene, id);
  if (!has_room) return;
  SceneState& state = scenes.state_of(*next.scene);
  for (SceneState* const one : {&scenes.states().front(), &state}) one->files_hold = false;
  ++replaced_;
  if (!is_root) scenes.attach(root);
  (void)remove_unheld();
  removing_ = true;
  for (SceneState* const one : {&scenes.states().front(), &state}) {
    SceneGraph& scene = *one->scene;
    std::vector<Route>& routes = scene.routes();
    std::erase_if(routes, [&](const Route& route) { return !scene.contains(route.from) || !scene.contains(route.to); });
    one->routes_seen = routes.size();
  }
  execution_.stacks().bind_first(state);
  execution_.cascade().drain();
  removing_ = false;
}

}  // namespace gs::vrml
