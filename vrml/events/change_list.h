#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Node with changed fields.
struct NodeChange {
  SceneGraph* scene = nullptr;
  NodeId node;
  std::uint64_t slots = 0;  // one bit per changed slot; the last bit stands for all slots above 62
};

/// List of the nodes of a world with changed fields or content. Each node is listed once. Part of Execution.
class ChangeList {
 public:
  explicit ChangeList(Execution& execution) : execution_(execution) {}

  /// Returns the nodes changed since the last call. Valid until the next step.
  [[nodiscard]] std::span<const NodeChange> take();
  /// Adds the change of a field.
  void mark(EventNode node, std::int32_t slot);
  /// Adds the new content of an Inline or an EXTERNPROTO instance. For an Inline, call it after
  /// SceneGraph::attach_inline and WorldScenes::attach.
  void mark_content(SceneGraph& scene, NodeId node);
  /// Discards the changes of removed nodes.
  void forget_removed();

 private:
  NodeChange& change_of(EventNode node);

  Execution& execution_;
  std::vector<NodeChange> changes_, taken_;
  std::vector<EventNode> changed_;
};

}  // namespace gs::vrml
