#pragma once

#include "base/box.h"
#include "vrml/event_model/behaviour.h"

#include <glm/vec3.hpp>

#include <optional>

namespace gs::vrml {

/// Returns the union of a local box of a node at all its instances, in world space, for Behaviour::idle_box. Returns
/// nullopt below a Billboard, because the box turns with the viewer, and if a matrix is almost singular.
[[nodiscard]] std::optional<WideBox> world_box_of(Execution& execution, EventNode node, const glm::dvec3& center,
                                                  const glm::dvec3& half);

}  // namespace gs::vrml
