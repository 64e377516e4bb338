#pragma once

#include "render/collection/nodes/collect_schema.h"
#include "render/scene/render_list.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <string_view>

// Functions that evaluate single nodes, without traversal. They clamp values to the ranges of the standard, and replace
// values that are not finite by the defaults.
namespace gs::render {

/// Returns the rotation nearest to a matrix: without scale, shear and mirroring.
[[nodiscard]] glm::dmat3 rotation_part(const glm::dmat4& matrix);
/// Returns parent_from_local of a Transform (VRML97 6.52).
[[nodiscard]] glm::dmat4 transform_matrix(const NodeView& transform);
/// Returns parent_from_local of a Billboard (6.6). `viewer` and `up` are in the space of its parent.
[[nodiscard]] glm::dmat4 billboard_matrix(const NodeView& billboard, const glm::dvec3& viewer, const glm::dvec3& up);
/// Returns the index of the visible level of an LOD (6.26). Returns -1 if it has no levels. `viewer` is in the LOD's
/// space.
[[nodiscard]] int lod_level(const NodeView& lod, const glm::dvec3& viewer);

/// Returns a DirectionalLight, PointLight or SpotLight in world space. Radius and attenuation scale with the
/// transformation, because they are in the light's space (4.14.4).
[[nodiscard]] Light world_light(const NodeView& light, const glm::dmat4& world_from_node);
/// Gives a list the nearest and farthest visible distance of the bound Viewpoint (X3D 23.3.1), or of the first one.
void take_distances(RenderList& list, const vrml::Node* bound);
/// Adds what a ViewpointGroup determines for its Viewpoints (X3D 23.4.7) to `state`.
void add_group(ViewpointState& state, const NodeView& group, const glm::dmat4& world_from_group);
/// Gives a Viewpoint what ViewpointGroups determine, from another one in the same groups.
void take_group(ViewpointState& viewpoint, const ViewpointState& other);
/// Returns a Viewpoint in world space. Ignores the scale of the transformation (6.53).
[[nodiscard]] ViewpointState world_viewpoint(const vrml::SceneGraph& scene, const NodeView& viewpoint,
                                             const glm::dmat4& world_from_node);
[[nodiscard]] NavigationState navigation_state(const NodeView& navigation_info);
[[nodiscard]] Background world_background(const NodeView& background, const glm::dmat4& world_from_node,
                                          const Images& images);
/// Returns a Fog; `world_from_node` defines its space. Returns no fog if the matrix is singular.
[[nodiscard]] Fog world_fog(const NodeView& fog, const glm::dmat4& world_from_node);

/// Returns a ClipPlane in world space. Returns a plane that clips nothing if a value is not finite or the matrix is
/// singular.
[[nodiscard]] glm::dvec4 world_clip_plane(const NodeView& clip_plane, const glm::dmat4& world_from_node);
/// Returns the style of LineProperties, FillProperties and PointProperties; each view may be empty.
[[nodiscard]] ShapeStyle style_of(const NodeView& line, const NodeView& fill, const NodeView& point);

/// Returns the colours of the front of a material node, with values clamped to the ranges of 6.27. For a
/// PhysicalMaterial, `diffuse` is the base colour, converted to a display.
[[nodiscard]] Material material_of(const NodeView& material);
/// Returns the field `detail` of a QNV node, 1/100 to 100. Returns 1 for other nodes.
[[nodiscard]] float detail_of(const NodeView& qnv);
/// Returns the matrix from texture coordinates of the mesh to texture space: -C * S * R * C * T, as printed in 6.49.
[[nodiscard]] glm::mat3 texture_matrix(const NodeView& texture_transform);
/// Returns the image of an SFImage. Returns an empty image if size, components and number of words do not fit.
[[nodiscard]] Image image_of(const vrml::PixelImage& pixels);

}  // namespace gs::render
