#pragma once

#include "vrml/event_model/parent_index.h"
#include "vrml/scene/scene_graph.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Positions of single nodes in the transformation hierarchy (VRML97 4.4.4) of a world and its Inlines. Sensors and the
/// bound Viewpoint use it. The first query indexes the hierarchy; later changes cost only the changed nodes. One
/// thread.
class Placement {
 public:
  using Path = ParentIndex::Path;

  explicit Placement(const SceneGraph& root) : index_(root) {}

  /// Discards the index. Call it after changes that children_changed() does not cover, and before a scene is freed.
  void forget();
  /// Notes that a field with children of the node changes. The next query takes in the new children.
  void children_changed(const SceneGraph& scene, NodeId node);
  /// Discards the data of a node that is about to be freed.
  void remove(const SceneGraph& scene, NodeId node);

  /// Returns world_from_local of each instance of the node, one per USE path, at most kMaxPlaces. Returns an empty list
  /// if the node is not in the hierarchy. Billboards above the node face `viewer` (world_from_viewer, 6.6); without a
  /// viewer, they do not turn. Valid until the next call.
  [[nodiscard]] std::span<const glm::dmat4> places_of(const SceneGraph& scene, NodeId node,
                                                      const std::optional<glm::dmat4>& viewer = {});
  /// Reports whether the node of the last places_of() has a Billboard above it on any path.
  [[nodiscard]] bool below_billboard() const { return below_billboard_; }
  /// Returns the transforming ancestors of each instance of the node. Valid until the next call of a function that is
  /// not const.
  [[nodiscard]] std::span<const Path> paths_of(const SceneGraph& scene, NodeId node);
  /// Reports whether the last search found all instances.
  [[nodiscard]] bool whole() const { return whole_; }
  /// Returns the number of nodes that the last change of the index visited.
  [[nodiscard]] std::size_t visits() const { return index_.visits(); }

  /// Nodes with new positions in the hierarchy.
  struct Moved {
    bool all = false;             // any node may have a new position
    std::vector<NodePlace> tops;  // else: these nodes, and the nodes below them
  };
  /// Returns the nodes that were added, removed or reordered since the last call.
  [[nodiscard]] Moved take_moved();
  /// Calls `visit` for each node at and below `top`; see ParentIndex::each_below.
  bool each_below(const NodePlace& top, std::size_t max_nodes,
                  const std::function<void(const NodePlace&)>& visit) const {
    return index_.each_below(top, max_nodes, visit);
  }

  static constexpr std::size_t kMaxPlaces = 64;

 private:
  struct Paths {
    std::uint64_t version = 0;  // version of the index with these paths; 0 means none
    bool whole = false;
    std::vector<Path> paths;
  };
  void refresh();

  ParentIndex index_;
  bool known_ = false, whole_ = false, below_billboard_ = false;
  std::uint64_t version_ = 0;       // increases with each change of the index
  std::vector<NodePlace> changed_;  // nodes with children that the index has not taken in
  Moved moved_;
  std::unordered_map<const Node*, Paths> paths_;  // paths to each node of a query
  std::vector<glm::dmat4> places_;
};

}  // namespace gs::vrml
