#pragma once

#include "vrml/scene/scene_graph.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Node, and the scene of the world that contains it.
struct NodePlace {
  const SceneGraph* scene = nullptr;
  NodeId node;
};

/// Positions of single nodes in the transformation hierarchy (VRML97 4.4.4) of a world and its Inlines. Sensors and the
/// bound Viewpoint use it. The first query after a change searches the hierarchy; Limits::visits bounds the search. One
/// thread.
class Placement {
 public:
  explicit Placement(const SceneGraph& root) : root_(root) {}

  /// Discards the search result. Call it after a change of the hierarchy.
  void forget() { known_ = false; }
  /// Returns world_from_local of each instance of the node, one per USE path, at most kMaxPlaces. Returns an empty list
  /// if the node is not in the hierarchy. Billboards above the node face `viewer` (world_from_viewer, 6.6); without a
  /// viewer, they do not turn. Valid until the next call.
  [[nodiscard]] std::span<const glm::dmat4> places_of(const SceneGraph& scene, NodeId node,
                                                      const std::optional<glm::dmat4>& viewer = {});
  /// Reports whether the node of the last places_of() has a Billboard above it on any path.
  [[nodiscard]] bool below_billboard() const { return below_billboard_; }

  /// Adds a node to the next search, so that one search finds many nodes.
  void look_for(const SceneGraph& scene, NodeId node) {
    if (paths_.try_emplace(&scene.node(node)).second) known_ = false;
  }
  /// Discards the data of a removed node.
  void remove(const Node& node) { paths_.erase(&node); }
  /// Reports whether the last search visited the whole hierarchy.
  [[nodiscard]] bool whole() const { return whole_; }
  /// Returns the number of nodes that the last search visited.
  [[nodiscard]] std::size_t visits() const { return visits_; }

  static constexpr std::size_t kMaxPlaces = 64;

 private:
  using Path = std::vector<NodePlace>;  // transforming ancestors of a node, outermost first
  void search();

  const SceneGraph& root_;
  bool known_ = false, whole_ = false, below_billboard_ = false;
  std::size_t visits_ = 0;
  std::unordered_map<const Node*, std::vector<Path>> paths_;  // paths to each node of a query
  std::vector<glm::dmat4> places_;
};

}  // namespace gs::vrml
