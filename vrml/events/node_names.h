#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// What traces call the nodes of a world and its Inlines: by their DEF names, else `Type#number`, where the number
/// counts the nodes of the type from 1 in the order in which they were made, those of PROTO instances among them, the
/// root's before those of Inlines. Nodes that are made later are counted when they are asked for. One thread.
class NodeNames {
 public:
  explicit NodeNames(const SceneGraph& root);

  [[nodiscard]] std::string of(const SceneGraph& scene, NodeId node);
  /// The node of the root with this DEF name, the last one if there are several, or of this `Type#number`; inside PROTO
  /// instances only where no other node has the name. Null: none.
  [[nodiscard]] NodeId find(std::string_view name);

 private:
  struct Number {
    std::uint32_t generation = 0, number = 0;  // number 0: part of a PROTO's declaration
  };
  struct Numbers {
    const SceneGraph* scene;
    std::vector<Number> of_node{1};  // by index
    std::uint64_t revision = 0;
  };
  void count(Numbers& numbers);
  void find_names();
  Numbers& numbers_of(const SceneGraph& scene);

  std::vector<Numbers> scenes_;
  std::unordered_map<std::string, std::uint32_t> counts_;  // by type name
  std::unordered_map<std::string_view, NodeId> named_;     // of the root
  std::uint64_t named_at_ = ~std::uint64_t{0};             // revision of the root when `named_` was made
};

}  // namespace gs::vrml
