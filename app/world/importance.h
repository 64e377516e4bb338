#pragma once

#include "vrml/scene/scene_graph.h"

#include <glm/vec3.hpp>

#include <unordered_map>
#include <unordered_set>

namespace gs::app {

/// How large nodes that wait for something are seen from `viewer` (world space): 0 not at all, 1 from within. Inlines
/// and QNV nodes by their bounding boxes, textures by their Shape's place; nodes without one count as middling.
/// Nodes that are not found in the live scene are left out. Bounded for any scene.
[[nodiscard]] std::unordered_map<const vrml::Node*, float> importance_of(
    const vrml::SceneGraph& scene, const std::unordered_set<const vrml::Node*>& wanted, const glm::dvec3& viewer);

}  // namespace gs::app
