#pragma once

#include "vrml/events/execution.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace gs::app {

/// A node of a world that lives, and in which of its scenes: the root or the content of an Inline. A null node: NULL.
struct NodeAt {
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;

  [[nodiscard]] explicit operator bool() const { return scene && id; }
  friend bool operator==(const NodeAt&, const NodeAt&) = default;
};

/// The nodes that one field of a node holds, or those that stand for it: what an Inline shows, the body of a PROTO
/// instance.
struct HeldNodes {
  static constexpr std::uint16_t kContent = 0xfffe, kBody = 0xffff;
  std::uint16_t place = 0;  // of the field in the type's interfaces, or one of these
  std::string_view field;   // its name, or "content" or "body"
  const vrml::SceneGraph* scene = nullptr;
  std::span<const vrml::NodeId> nodes;  // never empty
  bool list = false;                    // of an MFNode
};

/// Whether the node is a part of the world, now.
[[nodiscard]] bool is_in(const vrml::Execution& world, const NodeAt& node);
/// All that a node holds, in the order of its interface, into `held`; of a null node, the top-level nodes of the world.
/// Valid until the world goes on. Work follows the interface of the node, not the length of its lists.
void held_nodes(const vrml::Execution& world, const NodeAt& node, std::vector<HeldNodes>& held);

/// One step of the way from the root of a world to a node in it.
struct HeldStep {
  std::uint16_t place = 0;  // HeldNodes::place, in what the step before leads to; of the first one, 0
  std::uint32_t element = 0;
  NodeAt node;
};

}  // namespace gs::app
