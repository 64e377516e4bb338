#pragma once

#include "vrml/events/change_list.h"
#include "vrml/events/world_scenes.h"

#include <span>
#include <vector>

namespace gs::vrml {

/// Stacks of bindable nodes (VRML97 4.6.10), one per NodeKind: all types of viewpoints share one stack. A stack is a linked list of nodes, so that any node can be
/// removed in O(1). Part of Execution.
class BindableStacks {
 public:
  struct Stack {
    const NodeType* type;  // one of the types of its kind
    EventNode top = 0;
  };

  explicit BindableStacks(Execution& execution) : execution_(execution) {}

  /// If `to_top`, moves the node to the top of its type's stack; otherwise removes it from the stack.
  void bind(EventNode node, bool to_top);
  /// Returns the bound node of a type; 0 if no node is bound.
  [[nodiscard]] EventNode top_of(const NodeType& type) const;
  /// Returns the bound node of a type. Its scene is null if no node is bound.
  [[nodiscard]] NodeChange bound(const NodeType& type) const;
  /// Reports whether a bindable node is on its type's stack. The scene and the node may have been removed.
  [[nodiscard]] bool contains(const SceneGraph* scene, NodeId node) const;
  [[nodiscard]] std::span<const Stack> all() const { return stacks_; }
  /// Returns all nodes on all stacks. In each stack, lower nodes come first.
  [[nodiscard]] std::vector<EventNode> nodes();

  /// Binds the first node of each bindable type in a scene. Ignores its Inlines.
  void bind_first(SceneState& state) { bind_first_nodes(state, false); }
  /// Binds nodes of EXTERNPROTO bodies that were attached later. For each type of which no node was ever bound, binds
  /// the first node, as at the start of the world.
  void bind_new_types();
  /// Unbinds a node, as set_bind FALSE does.
  void unbind(EventNode node);
  /// Announces that nodes leave a grouping node. After the cascade, unbind_left() unbinds the nodes that left the
  /// hierarchy.
  void nodes_leave();
  void unbind_left();

 private:
  Stack& stack_of(const NodeType& type);
  void bind_first_nodes(SceneState& state, bool of_fresh_types);

  Execution& execution_;
  std::vector<Stack> stacks_;
  bool nodes_leave_ = false;
};

}  // namespace gs::vrml
