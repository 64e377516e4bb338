#include "vrml/events/bindable_stacks.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {

BindableStacks::Stack& BindableStacks::stack_of(const NodeType& type, int layer) {
  for (Stack& stack : stacks_)
    if (stack.type->read_as == type.read_as && stack.layer == layer) return stack;
  return stacks_.emplace_back(Stack{&type, layer});
}

EventNode BindableStacks::top_of(const NodeType& type, int layer) const {
  for (const Stack& stack : stacks_)
    if (stack.type->read_as == type.read_as && stack.layer == layer) return stack.top;
  return 0;
}

std::optional<LayerSet> BindableStacks::layers() const {
  const SceneGraph& world = execution_.scenes().root();
  return layer_set_ && world.contains(layer_set_) ? layer_set_of(world) : std::nullopt;
}

int BindableStacks::active_layer() const {
  if (!layer_set_) return 0;
  const std::optional<LayerSet> set = layers();
  return set ? set->active : 0;
}

std::vector<int> BindableStacks::layers_of(EventNode node) const {
  if (!layer_set_) return {0};
  const std::optional<LayerSet> set = layers();
  const EventMember& at = execution_.nodes()[node];
  if (!set || !execution_.budget().spend(execution_.placement().visits())) return {0};
  return vrml::layers_of(execution_.scenes().root(), *set, *at.scene, at.id);
}

bool BindableStacks::is_bound(EventNode node) const {
  return std::any_of(stacks_.begin(), stacks_.end(), [&](const Stack& stack) { return stack.top == node; });
}

NodeChange BindableStacks::bound(const NodeType& type, int layer) const {
  const EventNode top = top_of(type, layer);
  if (top == 0) return {};
  const EventMember& at = execution_.nodes()[top];
  return {at.scene, at.id, 0};
}

bool BindableStacks::contains(const SceneGraph* scene, NodeId node) const {
  const SceneState* const state = execution_.scenes().find(scene);
  const EventNode member = state && scene->contains(node) ? state->member_of(node) : 0;
  return member != 0 && execution_.nodes()[member].on_stack;
}

void BindableStacks::unlink(Stack& stack, EventNode node) {
  const auto found = stack.links.find(node);
  if (found == stack.links.end()) return;
  const Stack::Link link = found->second;
  stack.links.erase(found);
  if (link.above != 0) stack.links[link.above].below = link.below;
  if (link.below != 0) stack.links[link.below].above = link.above;
  if (stack.top == node) stack.top = link.below;
}

std::vector<BindableStacks::Change> BindableStacks::bind(EventNode node, bool to_top) {
  EventMember& at = execution_.nodes()[node];
  const NodeType& type = execution_.nodes().type_of(node);
  const bool leaves = !to_top && std::exchange(leaves_layers_, false);
  const std::vector<int> layers = to_top || leaves ? layers_of(node) : std::vector<int>();
  for (const int layer : layers)
    if (to_top) (void)stack_of(type, layer);
  std::vector<Change> changes;
  for (Stack& stack : stacks_) {
    const bool stays =
        stack.type->read_as == type.read_as && std::find(layers.begin(), layers.end(), stack.layer) != layers.end();
    const EventNode before = stack.top;
    if (stays && (before == node || leaves)) continue;
    unlink(stack, node);  // the node may also have left the layer
    if (stays) {
      stack.links[node] = {stack.top, 0};
      if (stack.top != 0) stack.links[stack.top].above = node;
      stack.top = node;
    }
    if (stack.top != before) changes.push_back({stack.layer, before, stack.top});
  }
  if (leaves) return changes;  // it was placed, and is on the stack of another layer
  if (!at.on_stack || !to_top) at.placed = false;
  at.on_stack = to_top;
  return changes;
}

std::vector<EventNode> BindableStacks::nodes() {
  std::vector<EventNode> found;
  for (const Stack& stack : stacks_)
    for (EventNode node = stack.top; node != 0 && execution_.budget().spend(EventBudget::kDelivery);
         node = stack.links.at(node).below)
      found.push_back(node);
  std::reverse(found.begin(), found.end());
  return found;
}

void BindableStacks::unbind(EventNode node) {
  (void)execution_.nodes().behaviour_of(node).on_event(execution_, node, kSetBind, FieldValue(false));
}

void BindableStacks::nodes_leave() {
  if (nodes_leave_ || !execution_.budget().spend(execution_.placement().visits())) return;
  nodes_leave_ = true;
  // Skips bound nodes that never were in the hierarchy, because such nodes cannot leave it.
  for (const EventNode node : nodes())
    if (!execution_.nodes()[node].placed)
      execution_.nodes()[node].placed = !execution_.viewer().places_of(node).empty();
}

void BindableStacks::unbind_left() {
  if (!std::exchange(nodes_leave_, false)) return;
  for (const EventNode node : nodes()) {
    if (!execution_.nodes()[node].placed) continue;
    if (!execution_.viewer().places_of(node).empty())
      leave_layers(node);
    else if (execution_.placement().whole())
      unbind(node);
  }
}

// Unbinds a node of the world in the layers that it has left.
void BindableStacks::leave_layers(EventNode node) {
  if (!layer_set_ || !execution_.budget().spend(execution_.placement().visits())) return;
  const std::vector<int> layers = layers_of(node);
  const bool has_left = std::any_of(stacks_.begin(), stacks_.end(), [&](const Stack& stack) {
    return stack.links.contains(node) && std::find(layers.begin(), layers.end(), stack.layer) == layers.end();
  });
  const bool stays = std::any_of(stacks_.begin(), stacks_.end(), [&](const Stack& stack) {
    return stack.links.contains(node) && std::find(layers.begin(), layers.end(), stack.layer) != layers.end();
  });
  if (!has_left) return;
  leaves_layers_ = stays;
  unbind(node);
  leaves_layers_ = false;
}

void BindableStacks::bind_new_types() {
  bind_first_nodes(execution_.scenes().states().front(), true);
  execution_.cascade().drain();
}

// Binds the first visible node of each type in file order, without Inlines (4.6.10). The standard does not say whether
// hidden children of a Switch are candidates. Other browsers skip them, and worlds use a Switch to choose their
// Background.
void BindableStacks::bind_first_nodes(SceneState& state, bool of_fresh_types) {
  SceneGraph& scene = *state.scene;
  if (const std::optional<LayerSet> set = layer_set_of(execution_.scenes().root()))
    layer_set_ = set->node;
  else
    layer_set_ = {};
  constexpr int kUnseen = -1;
  std::vector<int> seen(scene.nodes().count() + 1, kUnseen);  // number of the layer that has visited the node last
  std::vector<std::pair<const NodeType*, int>> known;
  for (const Stack& stack : stacks_)
    if (of_fresh_types) known.emplace_back(stack.type, stack.layer);
  struct Range {
    const NodeId* next;
    const NodeId* end;
    int layer = 0;
  };
  std::vector<Range> path{{scene.roots().begin(), scene.roots().end()}};
  while (!path.empty()) {
    if (path.back().next == path.back().end) {
      path.pop_back();
      continue;
    }
    const NodeId id = scene.resolve(*path.back().next++);
    const int layer = path.back().layer;
    if (!id || seen[id.index] == layer) continue;
    // With USE, several layers may share a large part of the world.
    if (seen[id.index] != kUnseen && !execution_.budget().spend(EventBudget::kDelivery)) continue;
    seen[id.index] = layer;
    const Node& node = scene.node(id);
    const bool is_known = std::any_of(known.begin(), known.end(), [&](const auto& stack) {
      return stack.first->read_as == node.type->read_as && stack.second == layer;
    });
    if (has(node.type->role, Role::bindable) && node.type->behaviour && !is_known &&
        !(of_fresh_types && node.owner != 0)) {
      const EventNode bindable = execution_.scenes().member(state, id);
      if (bindable != 0 && top_of(*node.type, layer) == 0)
        (void)node.type->behaviour->on_event(execution_, bindable, kSetBind, FieldValue(true));
      execution_.nodes()[bindable].placed = execution_.nodes()[bindable].on_stack;
    }
    if (!has(node.type->role, Role::grouping)) continue;
    if (id == layer_set_ && layer == 0) {
      const InterfaceDeclaration* const field = node.type->find_field("layers");
      const auto* layers = field ? std::get_if<MFNode>(&node.values[field->slot]) : nullptr;
      for (std::size_t k = layers ? layers->size() : 0; k-- > 0;)
        path.push_back({layers->begin() + k, layers->begin() + k + 1, static_cast<int>(k) + 1});
      continue;
    }
    const InterfaceDeclaration* which = node.type->find_field("whichChoice");
    const auto* chosen = which ? std::get_if<SFInt32>(&node.values[which->slot]) : nullptr;
    for (const InterfaceDeclaration& declaration : node.type->interfaces)
      if (declaration.slot >= 0 && !declaration.lists)
        if (const auto* children = std::get_if<MFNode>(&node.values[declaration.slot])) {
          const NodeId *begin = children->begin(), *end = children->end();
          if (chosen) {
            begin = *chosen < 0 || *chosen >= end - begin ? end : begin + *chosen;
            end = begin == end ? end : begin + 1;
          }
          path.push_back({begin, end, layer});
        }
  }
}

}  // namespace gs::vrml
