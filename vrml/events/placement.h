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

/// A node of a scene of the world.
struct NodePlace {
  const SceneGraph* scene = nullptr;
  NodeId node;
};

/// Where single nodes stand in the transformation hierarchy (VRML97 4.4.4) of a world and its Inlines: for sensors and
/// for the bound Viewpoint. The hierarchy is searched when somebody asks after it has changed; what that visits is
/// bounded by Limits::visits. One thread.
class Placement {
 public:
  explicit Placement(const SceneGraph& root) : root_(root) {}

  /// The hierarchy has changed.
  void forget() { known_ = false; }
  /// world_from_local of each place of the node, one for each USE that leads to it, at most kMostPlaces; none for a
  /// node that is not in the hierarchy. Billboards above it face `viewer` (world_from_viewer, 6.6); without one they
  /// count as if they did not turn. Valid until the next call.
  [[nodiscard]] std::span<const glm::dmat4> places_of(const SceneGraph& scene, NodeId node,
                                                      const std::optional<glm::dmat4>& viewer = {});
  /// Whether there is a Billboard above a place that the last call gave.
  [[nodiscard]] bool below_billboard() const { return below_billboard_; }

  /// The next search looks for this node, too: so that one search serves many.
  void look_for(const SceneGraph& scene, NodeId node) {
    if (paths_.try_emplace(&scene.node(node)).second) known_ = false;
  }
  /// The node is removed.
  void remove(const Node& node) { paths_.erase(&node); }
  /// Whether the last search saw the whole hierarchy.
  [[nodiscard]] bool whole() const { return whole_; }
  /// The nodes that it came by.
  [[nodiscard]] std::size_t visits() const { return visits_; }

  static constexpr std::size_t kMostPlaces = 64;

 private:
  using Path = std::vector<NodePlace>;  // the nodes that move what is below them, the outermost first
  void search();

  const SceneGraph& root_;
  bool known_ = false, whole_ = false, below_billboard_ = false;
  std::size_t visits_ = 0;
  std::unordered_map<const Node*, std::vector<Path>> paths_;  // of the nodes that were asked for
  std::vector<glm::dmat4> places_;
};

}  // namespace gs::vrml
