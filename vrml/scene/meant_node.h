#pragma once

#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

/// Returns the node with the role `wanted` that is meant by a node in a field of a Shape or an Appearance: the node
/// itself, the chosen child of a Switch, the first child of a Group, or the field of a Shape or Appearance with this
/// role. Returns null if none has the role. Old worlds contain such misplaced nodes, and stand-ins use them.
[[nodiscard]] NodeId meant_node(const SceneGraph& scene, NodeId id, Role wanted);

/// Parts of a Shape as far as the Shape gives them; null otherwise. Each may be misplaced, see meant_node().
struct ShapeParts {
  NodeId appearance, material, texture, texture_transform;
};
/// Returns the parts that a Shape has if its field `appearance` contains `given`.
[[nodiscard]] ShapeParts parts_of_appearance(const SceneGraph& scene, NodeId given);

}  // namespace gs::vrml
