#pragma once

#include "vrml/scene/meant_node.h"
#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

// These functions return the values of a geometric property node (VRML97 4.6.3.2), or of a PROTO instance that
// represents one. The node is in the named field of `geometry`. The result shares storage with the node. It is empty if
// there is no such node.

[[nodiscard]] inline MFVec3f coordinates_of(const SceneGraph& scene, NodeId geometry) {
  const NodeId node = scene.resolve_as(scene.get<SFNode>(geometry, "coord"), NodeKind::coordinate);
  return node ? scene.get<MFVec3f>(node, "point") : MFVec3f{};
}
[[nodiscard]] inline MFVec3f normals_of(const SceneGraph& scene, NodeId geometry) {
  const NodeId node = scene.resolve_as(scene.get<SFNode>(geometry, "normal"), NodeKind::normal);
  return node ? scene.get<MFVec3f>(node, "vector") : MFVec3f{};
}
[[nodiscard]] inline MFColor colors_of(const SceneGraph& scene, NodeId geometry) {
  const NodeId node = scene.resolve_as(scene.get<SFNode>(geometry, "color"), NodeKind::color);
  return node ? scene.get<MFColor>(node, "color") : MFColor{};
}
[[nodiscard]] inline MFVec2f texture_coordinates_of(const SceneGraph& scene, NodeId geometry) {
  const NodeId given = meant_node(scene, scene.get<SFNode>(geometry, "texCoord"), Role::geometric_property);
  const NodeId node = scene.resolve_as(given, NodeKind::texture_coordinate);
  return node ? scene.get<MFVec2f>(node, "point") : MFVec2f{};
}

}  // namespace gs::vrml
