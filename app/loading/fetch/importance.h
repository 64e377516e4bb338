#pragma once

#include "vrml/scene/scene_graph.h"

#include <glm/vec3.hpp>

#include <unordered_map>
#include <unordered_set>

namespace gs::app {

/// Returns the apparent sizes of nodes that wait for data, seen from `viewer` (world space). 0 means invisible, 1 means
/// that the viewer is inside. Inlines and QNV nodes use their bounding boxes, textures their Shapes. Nodes without
/// bounds get a medium size. Nodes outside the scene are omitted. The work is bounded for any scene.
[[nodiscard]] std::unordered_map<const vrml::Node*, float> importance_of(
    const vrml::SceneGraph& scene, const std::unordered_set<const vrml::Node*>& wanted, const glm::dvec3& viewer);

}  // namespace gs::app
