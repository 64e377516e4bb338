#pragma once

#include "vrml/scene/node.h"
#include "vrml/scene/scene_memory.h"
#include "vrml/scene/stable_vector.h"
#include "vrml/scene/values/value_pool.h"

#include <cassert>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::vrml {

/// Nodes of one scene, with their values. Indices of freed nodes are used again, with other generations. References to
/// nodes stay valid while nodes are added. One thread.
class NodeArena {
 public:
  /// `memory` must outlive the arena. The types of the nodes must outlive it as well.
  explicit NodeArena(SceneMemory& memory);
  ~NodeArena();
  NodeArena(const NodeArena&) = delete;
  NodeArena& operator=(const NodeArena&) = delete;

  [[nodiscard]] Node& operator[](NodeId id) {
    assert(contains(id));
    return nodes_[id.index];
  }
  [[nodiscard]] const Node& operator[](NodeId id) const {
    assert(contains(id));
    return nodes_[id.index];
  }
  [[nodiscard]] bool contains(NodeId id) const {
    return id && id.index < nodes_.size() && nodes_[id.index].generation == id.generation && id.generation != 0;
  }
  /// Returns the number of node indices. They are 1..count(), in the order of creation except for indices used again. A
  /// removed node's entry looks like a part of a PROTO declaration, and `contains` returns false for its id.
  [[nodiscard]] std::size_t count() const { return nodes_.size() - 1; }
  [[nodiscard]] NodeId id_at(std::uint32_t index) const { return {index, nodes_[index].generation}; }
  [[nodiscard]] const Node& at(std::uint32_t index) const { return nodes_[index]; }
  /// Returns a counter that increases whenever nodes are made or removed.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  /// Returns and clears the list of nodes that were made at run time, or at indices used again. The order of indices
  /// does not show that these nodes are new.
  [[nodiscard]] std::vector<NodeId> take_made() { return std::exchange(made_, {}); }

  /// Reserves `count` consecutive indices for create(), and returns the first. Returns 0 if memory or a limit is
  /// exhausted.
  [[nodiscard]] std::uint32_t reserve(std::uint32_t count);
  void release(std::uint32_t first, std::uint32_t count) { free_indices_[count].push_back(first); }
  /// Creates a node at a reserved index, in the text `text` with the index `owner`. Returns null if there is no memory
  /// for its values.
  NodeId create(std::uint32_t index, const NodeType& type, const SourceText& text, std::uint32_t owner,
                SourceLocation location);
  /// Frees a node. Appends the nodes that must be freed with it to `more`.
  void free(NodeId id, std::vector<NodeId>& more);
  /// Appends the default value of the last slot of its type to a node.
  void add_value(Node& node);
  /// Gives a node a type that begins with the slots of its own type. The values stay; values of further slots are the
  /// defaults of `type`. Moves the values. Returns false if there is no memory.
  [[nodiscard]] bool extend(NodeId id, const NodeType& type);

  /// Returns the text in which the value of a slot was written. This is the text of the node, unless IS passed the
  /// value on (VRML97 4.8.2). The base of relative URLs and access rights depend on this text.
  [[nodiscard]] const SourceText& text_of(NodeId id, int slot) const;
  void set_text(NodeId id, int slot, const SourceText& text);

 private:
  std::uint32_t next_generation();

  SceneMemory& memory_;
  ValuePool values_;
  StableVector<Node> nodes_;  // index 0 is unused, because it is NULL
  std::uint32_t generation_ = 0, generations_left_ = 0;
  std::uint64_t revision_ = 0;
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> free_indices_;  // first indices by length of their run
  std::vector<NodeId> made_;
  // Texts of values by node and slot, if different from the node's text.
  std::unordered_map<std::uint64_t, const SourceText*> value_texts_;
};

}  // namespace gs::vrml
