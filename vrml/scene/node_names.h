#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Names of a world's nodes in traces, including those of Inlines: the DEF name, or else `Type#number`. The number
/// counts the nodes of a type from 1 in order of creation, including nodes of PROTO instances; the root's come before
/// those of Inlines. Nodes created later are counted at the next query. Single-threaded.
class NodeNames {
 public:
  explicit NodeNames(const SceneGraph& root);

  [[nodiscard]] std::string of(const SceneGraph& scene, NodeId node);
  /// Returns the root's node with this DEF name (the last one if several) or this `Type#number`. Nodes inside PROTO
  /// instances match only if no other node has the name. Returns null if none matches.
  [[nodiscard]] NodeId find(std::string_view name);

 private:
  struct Number {
    std::uint32_t generation = 0, number = 0;  // number 0: part of a PROTO declaration
  };
  struct Numbers {
    const SceneGraph* scene;
    std::vector<Number> of_node{1};  // by node index
    std::uint64_t revision = 0;
  };
  void count(Numbers& numbers);
  void find_names();
  Numbers& numbers_of(const SceneGraph& scene);

  std::vector<Numbers> scenes_;
  std::unordered_map<std::string, std::uint32_t> counts_;  // by type name
  std::unordered_map<std::string_view, NodeId> named_;     // named nodes of the root
  std::uint64_t named_at_ = ~std::uint64_t{0};             // revision of the root at which `named_` was built
};

}  // namespace gs::vrml
