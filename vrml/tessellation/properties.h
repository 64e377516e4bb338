#pragma once

#include "vrml/mesh/mesh.h"
#include "vrml/scene/meant_node.h"
#include "vrml/scene/scene_graph.h"

#include <vector>

namespace gs::vrml {

// These functions return the values of a geometric property node (VRML97 4.6.3.2), or of a PROTO instance that
// represents one. The node is in the named field of `geometry`. The result shares storage with the node. It is empty if
// there is no such node.

template <class T>
[[nodiscard]] T property_of(const SceneGraph& scene, NodeId geometry, const char* name, NodeKind kind,
                            const char* values) {
  const NodeId given = meant_node(scene, scene.get<SFNode>(geometry, name), Role::geometric_property);
  const NodeId node = scene.resolve_as(given, kind);
  return node ? scene.get<T>(node, values) : T{};
}
[[nodiscard]] inline MFVec3f coordinates_of(const SceneGraph& scene, NodeId geometry) {
  return property_of<MFVec3f>(scene, geometry, "coord", NodeKind::coordinate, "point");
}
[[nodiscard]] inline MFVec3f normals_of(const SceneGraph& scene, NodeId geometry) {
  return property_of<MFVec3f>(scene, geometry, "normal", NodeKind::normal, "vector");
}
[[nodiscard]] inline MFColor colors_of(const SceneGraph& scene, NodeId geometry) {
  return property_of<MFColor>(scene, geometry, "color", NodeKind::color, "color");
}
/// Texture coordinates of a geometry node: the first set, and all sets if there are several, or if they have more than
/// two components. TextureCoordinateGenerators give no sets.
struct TextureCoordinates {
  MFVec2f first;
  std::vector<CoordinateSet> sets;
};
[[nodiscard]] TextureCoordinates texture_coordinate_sets_of(const SceneGraph& scene, NodeId geometry);
/// Returns the first set of texture coordinates of a geometry node.
[[nodiscard]] inline MFVec2f texture_coordinates_of(const SceneGraph& scene, NodeId geometry) {
  return texture_coordinate_sets_of(scene, geometry).first;
}

}  // namespace gs::vrml
