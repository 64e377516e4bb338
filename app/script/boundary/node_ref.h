#pragma once

#include "vrml/scene/values/field_value.h"

#include <cstddef>
#include <cstdint>

namespace gs::app::script {

/// Node in any scene of a world, as programs name it. A NodeId alone is unique only within its scene.
struct NodeRef {
  std::uint64_t scene = 0;  // SceneGraph::serial; 0 means no node
  vrml::NodeId id;
  [[nodiscard]] explicit operator bool() const { return scene != 0 && id; }
  friend bool operator==(const NodeRef&, const NodeRef&) = default;
};
struct HashNodeRef {
  std::size_t operator()(const NodeRef& node) const {
    return static_cast<std::size_t>(
        ((std::uint64_t{node.id.generation} << 32 | node.id.index) + node.scene * 0x85ebca6bU) * 0x9e3779b97f4a7c15U);
  }
};

/// Interface of a node: the index of a field or event in its type.
struct PlaceRef {
  NodeRef node;
  std::uint32_t place = 0;
  friend bool operator==(const PlaceRef&, const PlaceRef&) = default;
};
struct HashPlaceRef {
  std::size_t operator()(const PlaceRef& ref) const { return HashNodeRef()(ref.node) ^ (ref.place * 0x9e3779b9U); }
};

}  // namespace gs::app::script
