#pragma once

#include "vrml/mesh/face_set.h"
#include "vrml/scene/meant_node.h"
#include "vrml/scene/scene_graph.h"

#include <span>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Returns the value of a field. Returns `otherwise` if the node's type has no such field: X3D types have more fields
/// than VRML97 types of the same name.
template <class T>
[[nodiscard]] T field_or(const SceneGraph& scene, NodeId id, std::string_view field, T otherwise) {
  const Node& node = scene.node(id);
  const InterfaceDeclaration* declaration = node.type->find_field(field);
  const T* value = declaration ? std::get_if<T>(&node.values[declaration->slot]) : nullptr;
  return value ? *value : otherwise;
}

// These functions return the values of a geometric property node (VRML97 4.6.3.2), or of a PROTO instance that
// represents one. The node is in the named field of `geometry`. The result shares storage with the node. It is empty if
// there is no such node.

template <class T>
[[nodiscard]] T property_of(const SceneGraph& scene, NodeId geometry, const char* name, NodeKind kind,
                            const char* values) {
  const NodeId given = meant_node(scene, field_or(scene, geometry, name, SFNode{}), Role::geometric_property);
  const NodeId node = scene.resolve_as(given, kind);
  return node ? scene.get<T>(node, values) : T{};
}
[[nodiscard]] inline MFVec3f normals_of(const SceneGraph& scene, NodeId geometry) {
  return property_of<MFVec3f>(scene, geometry, "normal", NodeKind::normal, "vector");
}
/// Texture coordinates of a geometry node: the first set, and all sets if there are several, or if they have more than
/// two components. TextureCoordinateGenerators give no sets.
struct TextureCoordinates {
  MFVec2f first;
  std::vector<CoordinateSet> sets;
};
[[nodiscard]] TextureCoordinates texture_coordinate_sets_of(const SceneGraph& scene, NodeId geometry);
/// Sets the texture coordinates of faces from the node in the field `texCoord` of `geometry`. `index` is empty for
/// geometries without it.
void set_texture_coordinates(FaceSet& faces, const SceneGraph& scene, NodeId geometry, MFInt32 index = {});
/// Returns the part of the fog per coordinate (FogCoordinate, X3D 24.4.3).
[[nodiscard]] inline MFFloat fog_depths_of(const SceneGraph& scene, NodeId geometry) {
  return property_of<MFFloat>(scene, geometry, "fogCoord", NodeKind::fog_coordinate, "depth");
}

/// Coordinates of a Coordinate or CoordinateDouble node.
struct Coordinates {
  MFVec3f points;        // relative to `origin`
  glm::dvec3 origin{0};  // in node space
};
/// Returns points relative to the middle of their box if they are far from 0, so that they stay exact.
[[nodiscard]] Coordinates relative_points(std::span<const glm::dvec3> points);
/// Returns the coordinates of a geometry; empty if it has no node for them.
[[nodiscard]] Coordinates coordinates_of(const SceneGraph& scene, NodeId geometry);

/// Values of a Color or ColorRGBA node.
struct Colors {
  MFColor colors;
  Array<float> opacities;  // empty for a Color
};
[[nodiscard]] Colors colors_of(const SceneGraph& scene, NodeId geometry);

/// Sets colours, normals and fog depths of faces from the nodes in the fields of `geometry`, which has colorPerVertex
/// and normalPerVertex. The index fields are empty for geometries without them.
void set_properties(FaceSet& faces, const SceneGraph& scene, NodeId geometry, MFInt32 color_index = {},
                    MFInt32 normal_index = {});

}  // namespace gs::vrml
