#include "vrml/events/execution.h"

#include <algorithm>
#include <unordered_set>
#include <utility>

// Removal of run-time nodes, of Inlines and of whole worlds.
namespace gs::vrml {
namespace {

constexpr std::size_t kFewNodes = 256;  // run-time nodes created before a search for unheld nodes pays
// Fields and nodes that a search may visit per created node.
constexpr std::size_t kLooksPerNode = 16;

bool is_script(const Node& node) { return node.type->kind == NodeType::Kind::script; }

}  // namespace

void Execution::note_referring(EventNode node) {
  if (!std::exchange(nodes_[node].refers, true)) referring_.push_back(node);
}

// Marks the held nodes of a scene. Nodes of the file are skipped while they are held: their references to run-time
// nodes came by events and are listed in referring_.
class Execution::Marking {
 public:
  Marking(Execution& execution, SceneState& state)
      : execution_(execution), state_(state), scene_(*state.scene), marked_(scene_.node_count() + 1) {}

  /// Returns the nodes that nothing holds.
  std::vector<NodeId> find_unheld() {
    mark_held();
    while (!waiting_.empty()) {
      const NodeId id = waiting_.back();
      waiting_.pop_back();
      follow(id);
    }
    std::vector<NodeId> unheld;
    const auto look = [&](NodeId id) {
      if (scene_.contains(id) && !marked_[id.index]) unheld.push_back(id);
    };
    if (state_.files_hold) {
      for (const NodeId id : state_.at_run_time) look(id);
    } else {
      for (std::uint32_t i = 1; i <= scene_.node_count(); ++i)
        if (!scene_.node_at(i).in_prototype_body) look(scene_.id_at(i));
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

  void mark_values(const Node& node, EventNode member) {
    for (std::size_t i = 0; i < node.type->defaults.size(); ++i) mark(node.values[i]);
    if (member == 0) return;
    const Member& at = execution_.nodes_[member];
    for (std::size_t i = 0; i < at.schema->outs.size(); ++i) mark(execution_.out_values_[at.first_out + i]);
  }

  [[nodiscard]] EventNode member_of(NodeId id) const {
    return id.index < state_.members.size() ? state_.members[id.index] : 0;
  }

  template <class Visit>
  void each_target(const Member& at, const Visit& visit) {
    const std::size_t slots = at.schema->interfaces.size() * (at.schema->instance ? 2 : 1);
    for (std::size_t i = 0; i < slots; ++i)
      for (auto c = execution_.slots_[at.first_slot + i].first; c != 0; c = execution_.connections_[c].next)
        visit(execution_.nodes_[execution_.connections_[c].to]);
  }
  template <class Visit>
  void each_source(const Member& at, const Visit& visit) {
    for (auto c = at.first_in; c != 0; c = execution_.connections_[c].next_in)
      visit(execution_.nodes_[execution_.connections_[c].source]);
  }

  void mark_held() {
    if (const auto held = execution_.held_.find(&scene_); held != execution_.held_.end())
      for (const auto& [index, count] : held->second) mark(scene_.id_at(index));
    if (!state_.files_hold) return mark(FieldValue(scene_.roots()));
    for (const EventNode member : execution_.referring_)
      if (const Member& at = execution_.nodes_[member]; at.scene == &scene_ && of_file(*at.node))
        mark_values(*at.node, member);
    // Held through ROUTEs to and from nodes of the file.
    for (const NodeId id : state_.at_run_time) {
      const EventNode member = scene_.contains(id) ? member_of(id) : 0;
      if (member == 0) continue;
      const Member& at = execution_.nodes_[member];
      bool held = false;
      each_target(at, [&](const Member& target) { held = held || of_file(*target.node); });
      if (is_script(*at.node)) each_source(at, [&](const Member& source) { held = held || of_file(*source.node); });
      if (held) mark(id);
    }
  }

  void follow(NodeId id) {
    const Node& node = scene_.node(id);
    const EventNode member = member_of(id);
    mark_values(node, member);
    for (const NodeId inner : node.expansion) mark(inner);
    if (node.expansion_first != 0 && !node.in_prototype_body)
      for (std::uint32_t i = 0; i < node.type->prototype->nodes.size(); ++i)
        mark(scene_.id_at(node.expansion_first + i));
    if (node.instance != 0) mark(scene_.id_at(node.instance));
    // Default values that future instances may get.
    if (marked_texts_.insert(node.owner).second && node.owner != 0)
      for (const auto& type : scene_.text_at(node.owner).types())
        for (const FieldValue& value : type->defaults) mark(value);
    if (member == 0) return;
    const Member& at = execution_.nodes_[member];
    each_source(at, [&](const Member& source) { mark(source.id); });
    each_target(at, [&](const Member& target) {
      if (is_script(*target.node)) mark(target.id);
    });
  }

  Execution& execution_;
  SceneState& state_;
  const SceneGraph& scene_;
  std::vector<bool> marked_;
  std::vector<NodeId> waiting_;
  std::unordered_set<std::uint32_t> marked_texts_;
  std::size_t looks_ = 0;
};

void Execution::hold(const SceneGraph& scene, NodeId node) {
  if (scene.contains(node)) ++held_[&scene][node.index];
}

void Execution::release(const SceneGraph& scene, NodeId node) {
  const auto held = held_.find(&scene);
  if (held == held_.end() || !scene.contains(node)) return;
  const auto count = held->second.find(node.index);
  if (count != held->second.end() && --count->second == 0) held->second.erase(count);
}

// Amortizes the cost of searches over the created nodes.
void Execution::remove_if_many() {
  if (!removing_ && made_since_ >= std::max(kFewNodes, next_removal_)) (void)remove_unheld();
}

std::size_t Execution::remove_unheld() {
  if (std::exchange(removing_, true)) return 0;
  std::size_t removed = 0, looks = 0, left = 0;
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    SceneState& state = scenes_[i];
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

void Execution::remove_nodes(SceneState& state, const std::vector<NodeId>& nodes) {
  SceneGraph& scene = *state.scene;
  const auto member_of = [&](NodeId id) { return id.index < state.members.size() ? state.members[id.index] : 0; };
  std::vector<EventNode> members;
  for (const NodeId id : nodes)
    if (const EventNode member = member_of(id)) members.push_back(member);
  end_scripts(members);
  // Unbinds them as with set_bind FALSE (4.6.10); the next nodes on the stacks send isBound.
  for (const NodeId id : nodes)
    if (const EventNode member = member_of(id); member != 0 && nodes_[member].on_stack)
      (void)nodes_[member].schema->behaviour->on_event(*this, member, kSetBind, FieldValue(false));
  drain();
  for (const NodeId id : nodes) {
    if (removal_observer_) removal_observer_(scene, id);
    if (SceneGraph* const content = scene.inlined(id)) remove_scene(*content);
    if (const EventNode member = member_of(id)) remove_member(member);
  }
  scene.remove(nodes);
  const auto is_gone = [&](NodeId id) { return !scene.contains(id); };
  std::erase_if(state.at_run_time, is_gone);
  std::erase_if(state.waiting, is_gone);
  placement_.forget();
  pointing_->forget();
  drop_removed();
}

void Execution::remove_member(EventNode node) {
  Member& at = nodes_[node];
  const std::size_t slots = at.schema->interfaces.size() * (at.schema->instance ? 2 : 1);
  for (std::size_t i = 0; i < slots; ++i) {
    Slot& slot = slots_[at.first_slot + i];
    while (slot.first != 0) disconnect(slot.first);
    slot = {};
  }
  while (at.first_in != 0) disconnect(at.first_in);
  for (std::size_t i = 0; i < at.schema->outs.size(); ++i) out_values_[at.first_out + i] = {};
  if (slots != 0) free_slots_[slots].push_back(at.first_slot);
  if (!at.schema->outs.empty()) free_outs_[at.schema->outs.size()].push_back(at.first_out);
  if (at.on_stack) bind(node, false);
  if (const Behaviour* behaviour = at.schema->behaviour) {
    if (behaviour->pointing) pointing_->remove(node);
    if (behaviour->on_remove) behaviour->on_remove(*this, node);
  }
  if (at.alarm != 0) --live_alarms_;
  afforded_ -= at.most;
  placement_.remove(*at.node);
  scenes_[scene_places_.at(at.scene)].members[at.id.index] = 0;
  if (--at.schema->users == 0 && at.schema->type->kind != NodeType::Kind::built_in) schemas_.erase(at.schema->type);
  at = {};
  removed_members_.push_back(node);
}

void Execution::remove_scene(SceneGraph& scene) {
  std::vector<SceneGraph*> scenes{&scene};
  for (std::size_t i = 0; i < scenes.size(); ++i)
    for (const auto& [place, content] : scenes[i]->inlines())
      if (content) scenes.push_back(content.get());
  for (SceneGraph* const one : scenes) {
    const auto place = scene_places_.find(one);
    if (place == scene_places_.end()) continue;
    if (removal_observer_) removal_observer_(*one, {});
    const std::vector<EventNode> members = scenes_[place->second].members;
    for (const EventNode member : members)
      if (member != 0) remove_member(member);
    scenes_[place->second] = SceneState();
    free_scenes_.push_back(place->second);
    scene_places_.erase(place);
    held_.erase(one);
    if (next_world_ && next_world_->scene == one) next_world_.reset();
  }
}

void Execution::remove_content(SceneGraph& scene, NodeId inline_node) {
  SceneGraph* const content = scene.contains(inline_node) ? scene.inlined(inline_node) : nullptr;
  if (!content || !scene_places_.contains(&scene)) return;
  const bool was_removing = std::exchange(removing_, true);
  for (const EventNode node : bindables_on_stacks()) {
    const SceneGraph* inside = nodes_[node].scene;
    // The nodes of nested Inlines are removed as well.
    std::vector<const SceneGraph*> scenes{content};
    for (std::size_t i = 0; i < scenes.size() && inside; ++i) {
      if (scenes[i] == inside) {
        (void)type_of(node).behaviour->on_event(*this, node, kSetBind, FieldValue(false));
        break;
      }
      for (const auto& [place, inner] : scenes[i]->inlines())
        if (inner) scenes.push_back(inner.get());
    }
  }
  std::vector<const SceneGraph*> leaving{content};
  for (std::size_t i = 0; i < leaving.size(); ++i) {
    if (const auto place = scene_places_.find(leaving[i]); place != scene_places_.end())
      end_scripts(scenes_[place->second].members);
    for (const auto& [place, inner] : leaving[i]->inlines())
      if (inner) leaving.push_back(inner.get());
  }
  drain();
  remove_scene(*content);
  scene.attach_inline(inline_node, nullptr);
  placement_.forget();
  pointing_->forget();
  drop_removed();
  removing_ = was_removing;
  content_changed(scene, inline_node);
}

void Execution::content_changed(SceneGraph& scene, NodeId inline_node) {
  placement_.forget();
  pointing_->forget();
  constexpr std::uint64_t kNoField = std::uint64_t{1} << 63;
  if (const EventNode node = event_node(scene, inline_node)) change_of(node).slots |= kNoField;
}

// Reuses removed connections; safe here, since no cascade is running.
void Execution::drop_removed() {
  free_connections_.insert(free_connections_.end(), removed_connections_.begin(), removed_connections_.end());
  removed_connections_.clear();
  if (removed_members_.empty()) return;
  const auto is_removed = [&](EventNode node) { return nodes_[node].scene == nullptr; };
  std::erase_if(running_, is_removed);
  std::erase_if(looking_, is_removed);
  std::erase_if(referring_, is_removed);
  std::erase_if(new_scripts_, is_removed);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < changed_.size(); ++i) {
    if (is_removed(changed_[i])) continue;
    changed_[kept] = changed_[i];
    changes_[kept] = changes_[i];
    ++kept;
    nodes_[changed_[kept - 1]].change = static_cast<std::uint32_t>(kept);
  }
  changed_.resize(kept);
  changes_.resize(kept);
  std::erase_if(requests_,
                [&](const NodePlace& one) { return !has_scene(one.scene) || !one.scene->contains(one.node); });
  free_members_.insert(free_members_.end(), removed_members_.begin(), removed_members_.end());
  removed_members_.clear();
}

// ---- replaceWorld

bool Execution::replace_world(SceneGraph& scene, const MFNode& nodes) {
  if (!has_scene(&scene)) return false;
  for (const NodeId id : nodes)
    if (!scene.contains(id)) return false;
  for (const NodeId id : nodes) hold(scene, id);
  if (next_world_)
    for (const NodeId id : next_world_->nodes) release(*next_world_->scene, id);
  next_world_ = NextWorld{&scene, nodes};
  return true;
}

// Makes the scene's content an Inline of the root, as the root's only content.
bool Execution::move_to_root(SceneGraph& scene) {
  std::shared_ptr<SceneGraph> content;
  for (const SceneState& state : scenes_) {
    if (!state.scene) continue;
    for (const auto& [place, inlined] : state.scene->inlines())
      if (inlined.get() == &scene) content = inlined;
    if (!content) continue;
    std::vector<NodeId> holders;
    for (const auto& [place, inlined] : state.scene->inlines())
      if (inlined == content) holders.push_back(state.scene->id_at(place));
    for (const NodeId holder : holders) state.scene->attach_inline(holder, nullptr);
    break;
  }
  const NodeId shown = content ? root_.create(built_in_node_type(NodeKind::inline_node)) : NodeId{};
  if (!shown) return false;
  root_.set_roots({shown});
  root_.attach_inline(shown, std::move(content));
  return true;
}

void Execution::do_replace_world() {
  if (removing_) return;
  replaced_at_ = stamp_;
  const NextWorld next = *std::exchange(next_world_, std::nullopt);
  const bool is_root = next.scene == &root_;
  const bool has_room = is_root || move_to_root(*next.scene);
  if (has_room) next.scene->set_roots(next.nodes);
  for (const NodeId id : next.nodes) release(*next.scene, id);
  if (!has_room) return;
  scenes_.front().files_hold = false;
  scenes_[scene_places_.at(next.scene)].files_hold = false;
  ++replaced_;
  if (!is_root) attach(root_);
  (void)remove_unheld();
  removing_ = true;
  for (SceneGraph* const scene : {&root_, next.scene}) {
    std::vector<Route>& routes = scene->routes();
    std::erase_if(routes, [&](const Route& one) { return !scene->contains(one.from) || !scene->contains(one.to); });
    scenes_[scene_places_.at(scene)].routes_seen = routes.size();
  }
  bind_first_nodes(scenes_[scene_places_.at(next.scene)], false);
  drain();
  removing_ = false;
}

}  // namespace gs::vrml
