#pragma once

#include "qnv/codecs/gaussians/encode/chunk_store.h"
#include "qnv/codecs/gaussians/encode/harmonics_chunks.h"
#include "qnv/codecs/gaussians/encode/merge_tree.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace gs::qnv::gaussians {

/// Trees of one part of a scene in a store. The store has the merged nodes, and only the visibility of the leaves.
struct StoredTree {
  std::uint64_t offset = 0;  // of the merged nodes; the visibility of the leaves follows them
  std::size_t merged = 0;    // number of merged nodes
  std::vector<std::uint32_t> roots;
};
/// Reads trees. `source` must have the splats of the part. Returns nullopt if the store cannot be read.
[[nodiscard]] std::optional<MergeTree> read_tree(const StoredTree& stored, const Gaussians& source, float detail,
                                                 const SharedStore& store);

/// Nodes at the top of the trees of a part.
struct PartTop {
  Forest forest;                      // MergedNode::outside() marks nodes that have only children outside of it
  std::vector<std::uint32_t> places;  // indices of the nodes in the trees of the part
  Gaussians leaves;                   // splats of the nodes that are leaves
  std::vector<glm::vec3> harmonics;   // of the nodes
};
/// Returns at most `most` nodes that cover the whole part, and all nodes above them. Starts from the roots; replaces
/// the node with the largest error by its children until there are `most` nodes.
[[nodiscard]] PartTop top_of(const MergeTree& tree, const Gaussians& source, std::size_t most);
/// Stores trees, and records them with their top as finished work. `splats` is the number of splats of the part.
/// Returns nullopt if the store is full.
[[nodiscard]] std::optional<StoredTree> store_tree(const MergeTree& tree, const PartTop& top, std::string_view work,
                                                   std::size_t splats, SharedStore& store);
/// Reads trees and a top that an earlier run finished. Returns false if there are none for this number of splats.
[[nodiscard]] bool restore_tree(std::string_view work, std::size_t splats, const SharedStore& store, StoredTree& tree,
                                PartTop& top);
/// Appends the top of a part to bytes for another process of this program.
void append_top(std::vector<std::byte>& to, const PartTop& top);
/// Reads the next top of append_top() from bytes, and removes it. Returns nullopt if the bytes are too short.
[[nodiscard]] std::optional<PartTop> next_top(std::span<const std::byte>& from);

/// Forest of the tops of all parts.
struct TopForest {
  /// Part of a node, and its index in the trees of that part.
  struct Origin {
    std::uint32_t part = 0, place = 0;
  };
  Forest forest;
  std::vector<Origin> origins;  // of the nodes
  Gaussians leaves;
  std::vector<glm::vec3> harmonics;  // of the nodes

  void add(PartTop top);
};

}  // namespace gs::qnv::gaussians
