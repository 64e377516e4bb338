#pragma once

#include "vrml/events/world_scenes.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Lifetime of the nodes of a running world. Part of Execution.
///
/// Nodes made at run time (read_into) are removed when they are no longer held. A node is held by a node field or
/// eventOut of a held node, or by `hold`. Nodes of the world's files are held. A PROTO instance and its body nodes hold
/// each other. A ROUTE with a held target holds its source. A ROUTE from a held source holds a Script target, because
/// Scripts affect more than fields. Held nodes keep their names, types and texts.
class NodeLifetime {
 public:
  /// Called before each node is removed. A null node means that the whole scene is removed. Must not modify the
  /// Execution.
  using RemovalObserver = std::function<void(SceneGraph&, NodeId)>;

  explicit NodeLifetime(Execution& execution) : execution_(execution) {}

  void observe_removal(RemovalObserver observer) { observer_ = std::move(observer); }
  /// Holds the node for a user such as a script variable. Calls are counted.
  void hold(const SceneGraph& scene, NodeId node);
  void release(const SceneGraph& scene, NodeId node);
  /// Removes all nodes that are not held, and returns their number. Unbinds bound nodes among them (4.6.10). Also runs
  /// after a cascade if many nodes were made.
  std::size_t remove_unheld();
  /// Removes the content of an Inline and of its nested Inlines. The memory is freed when its last owner releases it.
  void remove_content(SceneGraph& scene, NodeId inline_node);
  /// Replaces the world by `nodes` when the cascade ends (4.12.10.8, replaceWorld). All `nodes` belong to one scene of
  /// the world: the root or an Inline. Removes all nodes that `nodes` do not hold, even nodes of files. Binds the first
  /// bindable nodes of the new world. The scene of an Inline becomes the only content of the root. Returns false if a
  /// node is not in the scene, or the scene is not in the world.
  bool replace_world(SceneGraph& scene, const MFNode& nodes);
  /// Replaces the world by nodes of the root scene; see above.
  bool replace_world(const MFNode& nodes);
  /// Replaces the top-level nodes of a scene of the world, for addRootNode and removeRootNode of X3D. Nodes of files
  /// stay in memory. Binds no nodes. Returns false if a node is not in the scene, or the scene is not in the world.
  bool set_roots(SceneGraph& scene, const MFNode& nodes);
  /// Returns how often the world or its top-level nodes were replaced.
  [[nodiscard]] std::uint32_t replaced() const { return replaced_; }
  /// Reports whether a replacement waits for the end of a cascade.
  [[nodiscard]] bool waits() const { return next_world_.has_value(); }

  /// Counts a node that was made at run time.
  void note_made() { ++made_since_; }
  /// Adds a node to the list of nodes with a changed node field or eventOut.
  void note_referring(EventNode node);
  /// Ends a cascade: replaces the world if requested, and removes nodes that are not held if many were made.
  void end_cascade();

 private:
  struct NextWorld {
    SceneGraph* scene;
    MFNode nodes;
  };

  class Marking;
  void remove_nodes(SceneState& state, const std::vector<NodeId>& nodes);
  void remove_scene(SceneGraph& scene);
  void remove_member(EventNode node);
  void forget_removed();
  bool move_to_root(SceneGraph& scene);
  void do_replace_world();

  Execution& execution_;
  RemovalObserver observer_;
  std::vector<EventNode> referring_;  // nodes with changed node fields or eventOuts
  // Number of calls of `hold` per node, by scene and node index.
  std::unordered_map<const SceneGraph*, std::unordered_map<std::uint32_t, std::size_t>> held_;
  std::unordered_map<const SceneGraph*, MFNode> roots_;  // top-level nodes that set_roots() holds
  std::size_t made_since_ = 0, next_removal_ = 0;  // run-time nodes made since the last removal; number for the next
  bool removing_ = false;
  std::optional<NextWorld> next_world_;
  std::uint64_t replaced_at_ = 0;  // serial number of the timestamp of the last replacement
  std::uint32_t replaced_ = 0;
};

}  // namespace gs::vrml
