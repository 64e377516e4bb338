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

int BindableStacks::layer_of(EventNode node) const {
  if (!layer_set_) return 0;
  const std::optional<LayerSet> set = layers();
  const EventMember& at = execution_.nodes()[node];
  if (!set || !execution_.budget().spend(execution_.placement().visits())) return 0;
  return vrml::layer_of(execution_.scenes().root(), *set, *at.scene, at.id);
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

void BindableStacks::bind(EventNode node, bool to_top) {
  EventNodes& nodes = execution_.nodes();
  EventMember& at = nodes[node];
  if (at.on_stack) {
    if (at.bound_above != 0) nodes[at.bound_above].bound_below = at.bound_below;
    if (at.bound_below != 0) nodes[at.bound_below].bound_above = at.bound_above;
    for (Stack& left : stacks_)  // the node may have moved to another layer
      if (left.top == node) left.top = at.bound_below;
  }
  if (!at.on_stack || !to_top) at.placed = false;
  at.on_stack = to_top;
  at.bound_above = 0;
  at.bound_below = 0;
  if (!to_top) return;
  Stack& stack = stack_of(nodes.type_of(node), layer_of(node));
  at.bound_below = stack.top;
  if (stack.top != 0) nodes[stack.top].bound_above = node;
  stack.top = node;
}

std::vector<EventNode> BindableStacks::nodes() {
  std::vector<EventNode> found;
  for (const Stack& stack : stacks_)
    for (EventNode node = stack.top; node != 0 && execution_.budget().spend(EventBudget::kDelivery);
         node = execution_.nodes()[node].bound_below)
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
  for (const EventNode node : nodes())
    if (execution_.nodes()[node].placed && execution_.viewer().places_of(node).empty() &&
        execution_.placement().whole())
      unbind(node);
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
  std::vector<bool> seen(scene.nodes().count() + 1);
  std::vector<const NodeType*> known;
  for (const Stack& stack : stacks_)
    if (of_fresh_types) known.push_back(stack.type);
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
    if (!id || seen[id.index]) continue;
    seen[id.index] = true;
    const Node& node = scene.node(id);
    const int layer = path.back().layer;
    const bool is_known = std::any_of(known.begin(), known.end(),
                                      [&](const NodeType* type) { return type->read_as == node.type->read_as; });
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
