#pragma once

#include "vrml/nodes/x3d/x3d_row.h"

#include <span>

namespace gs::vrml {

// Rows of the X3D node types, one function per file in this folder. node_type_table.cpp joins them.
[[nodiscard]] std::span<const X3DRow> x3d_animation_rows();
[[nodiscard]] std::span<const X3DRow> x3d_cad_rows();
[[nodiscard]] std::span<const X3DRow> x3d_core_rows();
[[nodiscard]] std::span<const X3DRow> x3d_dis_rows();
[[nodiscard]] std::span<const X3DRow> x3d_environment_rows();
/// Returns the rows of types with other fields in X3D 3 than in X3D 4.
[[nodiscard]] std::span<const X3DRow> x3d_former_rows();
[[nodiscard]] std::span<const X3DRow> x3d_geometry_rows();
[[nodiscard]] std::span<const X3DRow> x3d_geospatial_rows();
[[nodiscard]] std::span<const X3DRow> x3d_h_anim_rows();
[[nodiscard]] std::span<const X3DRow> x3d_navigation_rows();
[[nodiscard]] std::span<const X3DRow> x3d_nurbs_rows();
[[nodiscard]] std::span<const X3DRow> x3d_particle_systems_rows();
[[nodiscard]] std::span<const X3DRow> x3d_rendering_rows();
[[nodiscard]] std::span<const X3DRow> x3d_rigid_body_rows();
[[nodiscard]] std::span<const X3DRow> x3d_sensors_rows();
[[nodiscard]] std::span<const X3DRow> x3d_shaders_rows();
[[nodiscard]] std::span<const X3DRow> x3d_shape_rows();
[[nodiscard]] std::span<const X3DRow> x3d_sound_rows();
[[nodiscard]] std::span<const X3DRow> x3d_sound_processing_rows();
[[nodiscard]] std::span<const X3DRow> x3d_texturing_rows();
[[nodiscard]] std::span<const X3DRow> x3d_volume_rendering_rows();

}  // namespace gs::vrml
