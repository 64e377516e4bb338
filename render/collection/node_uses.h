#pragma once

#include "render/collection/collector.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gs::render {

/// Part of a RenderList that depends on a node.
struct NodeUse {
  static constexpr std::uint32_t kSplat = std::uint32_t{1} << 31;  // bit of `index`: set for splat items
  static constexpr std::uint32_t kUnshown = UINT32_MAX;            // `index` of a node that draws nothing so far
  const vrml::Node* node;
  std::uint32_t index;
  friend bool operator<(const NodeUse& a, const NodeUse& b) {
    return a.node != b.node ? std::less<>()(a.node, b.node) : a.index < b.index;
  }
};

/// Frames and items of a RenderList by the nodes that they depend on. Two tables, built at first use.
class NodeUses {
 public:
  /// Discards the tables. Call it after each new collection.
  void forget();
  /// Returns the frames that a node defines: `index` is a frame.
  [[nodiscard]] std::span<const NodeUse> of_frame(const vrml::Node* node, const RenderSources& sources);
  /// Returns the items and splat items that depend on a node.
  [[nodiscard]] std::span<const NodeUse> of_item(const vrml::Node* node, const RenderList& list,
                                                 const RenderSources& sources);

 private:
  void list_frames(const RenderSources& sources);
  void list_items(const RenderList& list, const RenderSources& sources);
  void add(const vrml::Node* node, std::uint32_t index);
  void add_geometry(const vrml::Node* geometry, const vrml::SceneGraph* scene, std::uint32_t index);
  void add_inner(const vrml::Node* node, const vrml::SceneGraph& scene, std::uint32_t index);
  void add_item(const RenderSources::Item& source, const vrml::SceneGraph* scene, std::uint32_t index);

  std::vector<NodeUse> frames_, items_;  // sorted by node
  bool frames_known_ = false, items_known_ = false;
};

/// Returns the first nodes in the fields of a node.
[[nodiscard]] std::vector<const vrml::Node*> inner_nodes(const vrml::SceneGraph& scene, const vrml::Node& node);

}  // namespace gs::render
