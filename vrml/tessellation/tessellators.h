#pragma once

#include "vrml/mesh/mesh.h"

namespace gs::vrml {

// Tessellators of the geometry nodes (VRML97 4.6.3), for the rows of the node table. `geometry` is a node of the row's
// own type. It is never a PROTO instance, but its SFNode fields may contain instances. All functions are pure and
// accept any field values; `tessellate` describes the results for broken input.
[[nodiscard]] Mesh tessellate_box(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_cone(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_cylinder(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_sphere(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_indexed_face_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_indexed_line_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_point_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_elevation_grid(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_outline_group(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_extrusion(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_geo_elevation_grid(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_nurbs_curve(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_nurbs_surface(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_nurbs_trimmed_surface(const SceneGraph& scene, NodeId geometry,
                                                    const MeshOptions& options);
[[nodiscard]] Mesh tessellate_nurbs_swept_surface(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_nurbs_swung_surface(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_text(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);

// Geometry nodes of X3D.
[[nodiscard]] Mesh tessellate_line_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_triangle_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_triangle_fan_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_triangle_strip_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_indexed_triangle_set(const SceneGraph& scene, NodeId geometry,
                                                   const MeshOptions& options);
[[nodiscard]] Mesh tessellate_indexed_triangle_fan_set(const SceneGraph& scene, NodeId geometry,
                                                       const MeshOptions& options);
[[nodiscard]] Mesh tessellate_indexed_triangle_strip_set(const SceneGraph& scene, NodeId geometry,
                                                         const MeshOptions& options);
[[nodiscard]] Mesh tessellate_quad_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_indexed_quad_set(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_arc_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_arc_close_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_circle_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_disk_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_polyline_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_polypoint_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_rectangle_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);
[[nodiscard]] Mesh tessellate_triangle_set_2d(const SceneGraph& scene, NodeId geometry, const MeshOptions& options);

// These functions return the node's measures along its axes, divided by the default measures.
[[nodiscard]] glm::vec3 scale_of_box(const SceneGraph& scene, NodeId geometry);
[[nodiscard]] glm::vec3 scale_of_cone(const SceneGraph& scene, NodeId geometry);
[[nodiscard]] glm::vec3 scale_of_cylinder(const SceneGraph& scene, NodeId geometry);
[[nodiscard]] glm::vec3 scale_of_sphere(const SceneGraph& scene, NodeId geometry);

// These functions estimate the work for the mesh of a node, in elements; see tessellation_cost.
[[nodiscard]] std::size_t cost_of_elevation_grid(const SceneGraph& scene, NodeId geometry);
[[nodiscard]] std::size_t cost_of_geo_elevation_grid(const SceneGraph& scene, NodeId geometry);
[[nodiscard]] std::size_t cost_of_extrusion(const SceneGraph& scene, NodeId geometry);
[[nodiscard]] std::size_t cost_of_nurbs_surface(const SceneGraph& scene, NodeId geometry);
[[nodiscard]] std::size_t cost_of_text(const SceneGraph& scene, NodeId geometry);

}  // namespace gs::vrml
