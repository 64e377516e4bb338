#pragma once

#include "vrml/events/execution.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gs::app {

/// Node of a live world, with its scene: the root scene or an Inline's content. A null id means NULL.
struct NodeAt {
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;

  [[nodiscard]] explicit operator bool() const { return scene && id; }
  friend bool operator==(const NodeAt&, const NodeAt&) = default;
};

/// Child nodes in one field of a node, or its implicit children: the content of an Inline, or the body of a PROTO
/// instance.
struct HeldNodes {
  static constexpr std::uint16_t kContent = 0xfffe, kBody = 0xffff;
  std::uint16_t place = 0;  // index of the field in the type's interfaces, or kContent or kBody
  std::string_view field;   // field name, "content" or "body"
  const vrml::SceneGraph* scene = nullptr;
  std::span<const vrml::NodeId> nodes;  // never empty
  bool list = false;                    // true for an MFNode
};

/// Reports whether the node is part of the world now.
[[nodiscard]] bool is_in(const vrml::Execution& world, const NodeAt& node);
/// Stores all children of a node in `held`, in the order of its interface; for a null node, the world's top-level
/// nodes. Valid until the world's next step. The cost depends on the node's interface, not on the length of its lists.
void held_nodes(const vrml::Execution& world, const NodeAt& node, std::vector<HeldNodes>& held);

/// Step of the path from a world's root to a node.
struct HeldStep {
  std::uint16_t place = 0;  // HeldNodes::place in the previous step's node; 0 in the first step
  std::uint32_t element = 0;
  NodeAt node;
};

}  // namespace gs::app
