#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// State of one scene in the execution model.
struct SceneState {
  explicit SceneState(SceneGraph* of = nullptr) : scene(of) {}
  SceneGraph* scene = nullptr;     // null if the entry is free
  std::vector<EventNode> members;  // EventNode of each node index; 0 means none
  std::size_t nodes_seen = 1, routes_seen = 0;
  std::vector<NodeId> waiting;      // instances of EXTERNPROTOs without a body so far
  std::vector<NodeId> at_run_time;  // nodes made at run time
  bool files_hold = true;           // the nodes of the scene's file are held
  bool lives = false;               // is attached; nodes added from now on count as made at run time

  [[nodiscard]] EventNode member_of(NodeId id) const { return id.index < members.size() ? members[id.index] : 0; }
};

/// Scenes of a world: the root and the contents of its Inlines. Adds their nodes, ROUTEs and PROTO instances to the
/// execution model. Part of Execution.
class WorldScenes {
 public:
  WorldScenes(Execution& execution, SceneGraph& root);

  [[nodiscard]] SceneGraph& root() { return root_; }
  [[nodiscard]] const SceneGraph& root() const { return root_; }
  /// Adds the nodes, ROUTEs and EXTERNPROTO bodies that the root and its Inlines got since the last call.
  void attach();
  /// Adds the new nodes of one scene of the world, after vrml::read_into. ROUTEs between nodes made at run time move
  /// from SceneGraph::routes into the RouteTable.
  void attach(SceneGraph& scene);

  /// Reports whether the scene is the root or the content of an Inline of this world.
  [[nodiscard]] bool has(const SceneGraph* scene) const { return places_.contains(scene); }
  /// Returns the mutable scene if it belongs to this world; otherwise null.
  [[nodiscard]] SceneGraph* own(const SceneGraph& scene);
  /// Returns the EventNode of a node. Returns 0 if its scene is not part of the world, or if the budget is exhausted.
  [[nodiscard]] EventNode event_node(const SceneGraph& scene, NodeId node);
  /// Like event_node(), for a node of the scene with this state.
  [[nodiscard]] EventNode member(SceneState& state, NodeId id);

  /// Returns the states of all scenes, the root's first. An entry without a scene is free.
  [[nodiscard]] std::deque<SceneState>& states() { return states_; }
  /// Returns the state of a scene; null if the scene is not part of the world.
  [[nodiscard]] SceneState* find(const SceneGraph* scene);
  [[nodiscard]] const SceneState* find(const SceneGraph* scene) const;
  /// Returns the state of a scene. The scene becomes part of the world.
  [[nodiscard]] SceneState& state_of(SceneGraph& scene) { return states_[place_of(scene)]; }
  /// Frees the state of a scene.
  void remove(const SceneGraph& scene);
  /// Returns the number of scenes that were removed so far.
  [[nodiscard]] std::uint64_t removals() const { return removals_; }

 private:
  std::size_t place_of(SceneGraph& scene);
  void attach_all(std::vector<std::size_t> order);
  void attach_scene(SceneState& state);
  void attach_node(SceneState& state, NodeId id);
  void note_content(const SceneGraph& scene, NodeId inline_node);
  bool attach_instance(SceneState& state, NodeId id);

  Execution& execution_;
  SceneGraph& root_;
  std::deque<SceneState> states_;
  std::unordered_map<const SceneGraph*, std::size_t> places_;
  std::vector<std::size_t> free_places_;
  std::uint64_t removals_ = 0;
};

}  // namespace gs::vrml
