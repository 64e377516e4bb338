#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Node, and the scene of the world that contains it.
struct NodePlace {
  const SceneGraph* scene = nullptr;
  NodeId node;
};

/// Parents of the nodes in the transformation hierarchy (VRML97 4.4.4) of a world and its Inlines. Also contains hidden
/// children, which continue to send events (6.26, 6.46). Leaves without a behaviour are left out. One thread.
///
/// The scenes must not be freed between build() and the last other call. The order of the children is that of the
/// fields, so that paths have the order of a search from the root.
class ParentIndex {
 public:
  using Path = std::vector<NodePlace>;  // transforming ancestors of a node, outermost first

  explicit ParentIndex(const SceneGraph& root) : root_(root) {}

  /// Indexes the whole hierarchy. Visits each node once.
  void build();
  /// Takes in the present children of a node. Returns false if they are unchanged, or if the node is not in the index.
  /// Otherwise appends the children that left, came or moved to `moved`.
  bool update(const SceneGraph& scene, NodeId node, std::vector<NodePlace>& moved);
  /// Removes a node that is about to be freed. Returns true if the node had a parent.
  bool remove(const SceneGraph& scene, NodeId node);

  /// Replaces `paths` by the paths to each instance of the node, at most `max_paths`. Returns false if the search
  /// stopped at Limits::visits, so that paths may be missing.
  [[nodiscard]] bool find_paths(const SceneGraph& scene, NodeId node, std::size_t max_paths, std::vector<Path>& paths);
  /// Calls `visit` for the node and for all nodes below it, once each. Returns false if there are more than
  /// `max_nodes`.
  bool each_below(const NodePlace& top, std::size_t max_nodes,
                  const std::function<void(const NodePlace&)>& visit) const;

  /// Returns the number of nodes that the last build() or update() visited.
  [[nodiscard]] std::size_t visits() const { return visits_; }

 private:
  /// Node in the index. Node 0 is the top of the scene, which is the parent of its roots.
  struct Place {
    std::uint32_t scene = 0, node = 0;
    friend bool operator==(const Place&, const Place&) = default;
  };
  /// Relation between two nodes of one scene. Edges of a parent are a list in order; edges of a child are a list too.
  struct Edge {
    std::uint32_t parent = 0, child = 0;
    std::uint32_t next_of_parent = 0;
    std::uint32_t next_of_child = 0, previous_of_child = 0;
    std::uint32_t position = 0;  // increases along the list of the parent
  };
  struct Scene {
    const SceneGraph* graph = nullptr;
    std::vector<Edge> edges{1};  // index 0 means none
    std::vector<std::uint32_t> free_edges;
    std::vector<std::uint32_t> first_as_parent, first_as_child;  // first edge by node index
    std::vector<bool> known;                                     // by node index: the children are in the index
    std::vector<Place> holders;                                  // Inlines with this content
  };
  struct Step {
    std::uint64_t key;
    std::uint32_t position;
  };
  using Downs = std::unordered_map<std::uint64_t, std::vector<Step>>;

  static std::uint64_t key_of(Place place) { return std::uint64_t{place.scene} << 32 | place.node; }
  static Place place_at(std::uint64_t key) {
    return {static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key)};
  }
  std::uint32_t scene_of(const SceneGraph& graph);
  [[nodiscard]] NodePlace node_at(Place place) const;
  static void make_room(Scene& scene);
  void list_children(Place place);
  void take_in(Place top);
  std::uint32_t link(Scene& scene, std::uint32_t parent, std::uint32_t child, std::uint32_t after);
  void unlink(Scene& scene, std::uint32_t edge, std::uint32_t before);
  [[nodiscard]] bool walk_up(Place place, std::vector<Path>& paths) const;
  bool climb(Place place, Downs& downs) const;
  [[nodiscard]] bool descend(Place target, const Downs& downs, std::size_t max_paths, std::vector<Path>& paths) const;

  const SceneGraph& root_;
  std::vector<Scene> scenes_;
  std::unordered_map<const SceneGraph*, std::uint32_t> numbers_;
  std::size_t visits_ = 0;
  std::vector<std::uint32_t> fresh_, old_;  // scratch
};

}  // namespace gs::vrml
