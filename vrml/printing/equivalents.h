#pragma once

#include "vrml/printing/made_node.h"
#include "vrml/scene/scene_graph.h"

// Makers of VRML97 nodes for nodes that only X3D has (Vrml97Equivalent::make).
namespace gs::vrml {

// TriangleSet and its relatives as IndexedFaceSet with the same Coordinate (X3D 11.4, 32.4).
[[nodiscard]] MadeNode faces_of_triangle_set(const SceneGraph& scene, NodeId node, const NodeType& type);
[[nodiscard]] MadeNode faces_of_triangle_fan_set(const SceneGraph& scene, NodeId node, const NodeType& type);
[[nodiscard]] MadeNode faces_of_triangle_strip_set(const SceneGraph& scene, NodeId node, const NodeType& type);
[[nodiscard]] MadeNode faces_of_quad_set(const SceneGraph& scene, NodeId node, const NodeType& type);
/// LineSet as IndexedLineSet.
[[nodiscard]] MadeNode lines_of_line_set(const SceneGraph& scene, NodeId node, const NodeType& type);
/// Geometry with a tessellator as IndexedFaceSet, IndexedLineSet or PointSet.
[[nodiscard]] MadeNode tessellated_node(const SceneGraph& scene, NodeId node, const NodeType& type);

// Properties with other types of numbers.
[[nodiscard]] MadeNode color_of_color_rgba(const SceneGraph& scene, NodeId node, const NodeType& type);
[[nodiscard]] MadeNode coordinate_of_doubles(const SceneGraph& scene, NodeId node, const NodeType& type);

// Materials of X3D 4.
[[nodiscard]] MadeNode material_of_unlit(const SceneGraph& scene, NodeId node, const NodeType& type);
[[nodiscard]] MadeNode material_of_physical(const SceneGraph& scene, NodeId node, const NodeType& type);

/// OrthoViewpoint as a distant Viewpoint with a narrow angle (X3D 23.4.5).
[[nodiscard]] MadeNode viewpoint_of_ortho(const SceneGraph& scene, NodeId node, const NodeType& type);

// Groups with other names for their children.
[[nodiscard]] MadeNode group_of_cad_face(const SceneGraph& scene, NodeId node, const NodeType& type);
[[nodiscard]] MadeNode transform_of_humanoid(const SceneGraph& scene, NodeId node, const NodeType& type);

}  // namespace gs::vrml
