#pragma once

#include "vrml/events/execution.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Node of a running world with its scene, which is the root scene or the content of an Inline. A null id means NULL.
struct NodeAt {
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;

  [[nodiscard]] explicit operator bool() const { return scene && id; }
  friend bool operator==(const NodeAt&, const NodeAt&) = default;
};

/// Children of a node in one of its fields. The content of an Inline and the body of a PROTO instance count as fields.
struct HeldNodes {
  static constexpr std::uint16_t kContent = 0xfffe, kBody = 0xffff;
  std::uint16_t place = 0;  // index of the field in the type's interfaces, or kContent, or kBody
  std::string_view field;   // field name, "content" or "body"
  const vrml::SceneGraph* scene = nullptr;
  std::span<const vrml::NodeId> nodes;  // never empty
  bool list = false;                    // true for MFNode, false for SFNode
};

/// Returns true if the node is part of the world now.
[[nodiscard]] bool is_in(const vrml::Execution& world, const NodeAt& node);
/// Stores all children of a node in `held`, in the order of the node's interface. For a null node, stores the top-level
/// nodes of the world. Valid until the next step of the world. The cost does not depend on the length of lists.
void held_nodes(const vrml::Execution& world, const NodeAt& node, std::vector<HeldNodes>& held);

/// Returns a description of the content of a node without a name, such as "Box" or "Wheel, 3 more": the first named
/// node or geometry below it. Returns an empty text if there is none. Visits at most a few nodes.
[[nodiscard]] std::string content_name(const NodeAt& node);

/// One step of the path from the top level of a world to a node.
struct HeldStep {
  std::uint16_t place = 0;  // HeldNodes::place in the node of the previous step; 0 in the first step
  std::uint32_t element = 0;
  NodeAt node;
};

}  // namespace gs::app
