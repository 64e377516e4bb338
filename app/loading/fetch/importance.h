#pragma once

#include "vrml/scene/scene_graph.h"

#include <glm/vec3.hpp>

#include <unordered_map>
#include <unordered_set>

namespace gs::app {

/// Returns the apparent size of nodes that wait for data, seen from `viewer` (world space): 0 if invisible, 1 from
/// inside. Uses the bounding boxes of Inlines and QNV nodes, and the Shapes of textures; nodes without bounds get a
/// medium value. Omits nodes that are not in the scene. The work is bounded for any scene.
[[nodiscard]] std::unordered_map<const vrml::Node*, float> importance_of(
    const vrml::SceneGraph& scene, const std::unordered_set<const vrml::Node*>& wanted, const glm::dvec3& viewer);

}  // namespace gs::app
