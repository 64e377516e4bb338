#pragma once

#include "vrml/scene/node_type.h"

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <utility>

namespace gs::vrml {

class SceneGraph;

/// Contents of the Inline nodes of a scene. Each content has a separate name scope (VRML97 4.4.3). One thread.
class InlineContents {
 public:
  /// Sets the content of an Inline node. Null removes the content.
  void attach(NodeId inline_node, std::shared_ptr<SceneGraph> content) {
    if (content)
      contents_[inline_node.index] = std::move(content);
    else
      contents_.erase(inline_node.index);
  }
  /// Returns the content of an Inline node; null if it has none.
  [[nodiscard]] SceneGraph* of(NodeId inline_node) const {
    const auto found = contents_.find(inline_node.index);
    return found == contents_.end() ? nullptr : found->second.get();
  }
  /// Returns the contents by the index of their Inline node.
  [[nodiscard]] const std::unordered_map<std::uint32_t, std::shared_ptr<SceneGraph>>& all() const { return contents_; }

 private:
  std::unordered_map<std::uint32_t, std::shared_ptr<SceneGraph>> contents_;
};

}  // namespace gs::vrml
