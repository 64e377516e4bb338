#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Names of a world's nodes in traces, including nodes of Inlines. A name is the DEF name, or else `Type#number`. The
/// number counts the nodes of a type from 1 in order of creation, including nodes of PROTO instances. The root's nodes
/// precede those of Inlines. Nodes that are created later get their numbers at the next query. One thread.
class NodeNames {
 public:
  explicit NodeNames(const SceneGraph& root);

  [[nodiscard]] std::string of(const SceneGraph& scene, NodeId node);
  /// Returns the root's node with the DEF name `name`, or with `name` as `Type#number`. If several nodes have the DEF
  /// name, returns the last one. Nodes inside PROTO instances match only if no other node does. Returns null if no node
  /// matches.
  [[nodiscard]] NodeId find(std::string_view name);

 private:
  struct Number {
    std::uint32_t generation = 0, number = 0;  // number 0 means that the node belongs to a PROTO declaration
  };
  struct Numbers {
    const SceneGraph* scene;
    std::vector<Number> of_node{1};  // indexed by node index
    std::uint64_t revision = 0;
  };
  void count(Numbers& numbers);
  void find_names();
  Numbers& numbers_of(const SceneGraph& scene);

  std::vector<Numbers> scenes_;
  std::unordered_map<std::string, std::uint32_t> counts_;  // number of nodes of each type name
  std::unordered_map<std::string_view, NodeId> named_;  // nodes of the root scene with DEF names
  std::uint64_t named_at_ = ~std::uint64_t{0};  // revision of the root when `named_` was built
};

}  // namespace gs::vrml
