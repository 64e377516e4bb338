#pragma once

#include "vrml/events/change_list.h"
#include "vrml/events/world_scenes.h"
#include "vrml/scene/layers.h"

#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Stacks of bindable nodes (VRML97 4.6.10), one per NodeKind and layer (X3D 35.2.2): all types of viewpoints share one
/// stack. A node in several layers is on the stack of each of them. A stack is a linked list of nodes, so that any node
/// can be removed in O(1). Part of Execution.
class BindableStacks {
 public:
  struct Stack {
    const NodeType* type;  // one of the types of its kind
    int layer = 0;         // number of the layer; 0 for nodes outside of layers
    EventNode top = 0;
    struct Link {
      EventNode below = 0, above = 0;  // next lower and next higher node
    };
    std::unordered_map<EventNode, Link> links{};  // of its nodes
  };
  /// Change of the top of a stack.
  struct Change {
    int layer = 0;
    EventNode before = 0, after = 0;
  };

  explicit BindableStacks(Execution& execution) : execution_(execution) {}

  /// If `to_top`, moves the node to the top of its type's stack in each of its layers; otherwise removes it from the
  /// stacks. Returns the changes of their tops.
  std::vector<Change> bind(EventNode node, bool to_top);
  /// Reports whether the node is the top of a stack.
  [[nodiscard]] bool is_bound(EventNode node) const;
  /// Returns the bound node of a type in the active layer; 0 if no node is bound.
  [[nodiscard]] EventNode top_of(const NodeType& type) const { return top_of(type, active_layer()); }
  [[nodiscard]] EventNode top_of(const NodeType& type, int layer) const;
  /// Returns the bound node of a type in the active layer. Its scene is null if no node is bound.
  [[nodiscard]] NodeChange bound(const NodeType& type) const { return bound(type, active_layer()); }
  [[nodiscard]] NodeChange bound(const NodeType& type, int layer) const;
  /// Returns the layers of the world, as its LayerSet has them now; nullopt for a world without a LayerSet.
  [[nodiscard]] std::optional<LayerSet> layers() const;
  /// Returns the number of the layer in which the user navigates; 0 for a world without a LayerSet.
  [[nodiscard]] int active_layer() const;
  /// Returns the numbers of the layers that contain a node; 0 for a world without a LayerSet.
  [[nodiscard]] std::vector<int> layers_of(EventNode node) const;
  /// Reports whether a bindable node is on its type's stack. The scene and the node may have been removed.
  [[nodiscard]] bool contains(const SceneGraph* scene, NodeId node) const;
  [[nodiscard]] std::span<const Stack> all() const { return stacks_; }
  /// Returns all nodes on all stacks, possibly repeatedly. In each stack, lower nodes come first.
  [[nodiscard]] std::vector<EventNode> nodes();

  /// Binds the first node of each bindable type in a scene. Ignores its Inlines.
  void bind_first(SceneState& state) { bind_first_nodes(state, false); }
  /// Binds nodes of EXTERNPROTO bodies that were attached later. For each type of which no node was ever bound in a
  /// layer, binds the first node there, as at the start of the world.
  void bind_new_types();
  /// Unbinds a node, as set_bind FALSE does.
  void unbind(EventNode node);
  /// Announces that nodes leave a grouping node. After the cascade, unbind_left() unbinds the nodes that left the
  /// hierarchy, and those that left a layer in this layer.
  void nodes_leave();
  void unbind_left();

 private:
  Stack& stack_of(const NodeType& type, int layer);
  static void unlink(Stack& stack, EventNode node);
  void leave_layers(EventNode node);
  void bind_first_nodes(SceneState& state, bool of_fresh_types);

  Execution& execution_;
  std::vector<Stack> stacks_;
  NodeId layer_set_;  // node in the root scene; the null id for a world without a LayerSet
  bool nodes_leave_ = false;
  bool leaves_layers_ = false;  // bind() removes the node only from the stacks of the layers that it has left
};

}  // namespace gs::vrml
