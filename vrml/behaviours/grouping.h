#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/values/field_value.h"

#include <glm/mat4x4.hpp>

namespace gs::vrml {

// Reactions of grouping nodes, for the Behaviours of other grouping nodes.

/// Handles addChildren and removeChildren (VRML97 4.6.5). The first three names of Behaviour::events must be
/// addChildren, removeChildren and children.
bool change_children(Execution& execution, EventNode node, int event, const FieldValue& value);
/// Returns the transform of a node with the fields of a Transform (VRML97 6.52).
[[nodiscard]] glm::dmat4 transform_of(const SceneGraph& scene, const Node& node);

}  // namespace gs::vrml
