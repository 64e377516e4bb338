#pragma once

#include "render/collection/collect_schema.h"
#include "render/scene/render_list.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <string_view>

// Evaluation of single nodes, independent of the traversal. Values outside the ranges of the standard are clamped;
// non-finite values are replaced by the defaults.
namespace gs::render {

/// Returns parent_from_local of a Transform (VRML97 6.52).
[[nodiscard]] glm::dmat4 transform_matrix(const NodeView& transform);
/// Returns parent_from_local of a Billboard seen from `viewer`, in its parent's space (6.6).
[[nodiscard]] glm::dmat4 billboard_matrix(const NodeView& billboard, const glm::dvec3& viewer, const glm::dvec3& up);
/// Returns the index of the level to show, -1 for none; `viewer` is in the LOD's space (6.26).
[[nodiscard]] int lod_level(const NodeView& lod, const glm::dvec3& viewer);

/// Returns any of the three lights in world space. Radius and attenuation scale with the transformation, because the
/// standard measures them in the light's space (4.14.4).
[[nodiscard]] Light world_light(const NodeView& light, const glm::dmat4& world_from_node);
/// Returns a Viewpoint in world space, without the transformation's scale (6.53).
[[nodiscard]] ViewpointState world_viewpoint(const NodeView& viewpoint, const glm::dmat4& world_from_node);
[[nodiscard]] NavigationState navigation_state(const NodeView& navigation_info);
[[nodiscard]] Background world_background(const NodeView& background, const glm::dmat4& world_from_node,
                                          const Images& images);
/// Returns the Fog with its space from `world_from_node`; none if that is singular.
[[nodiscard]] Fog world_fog(const NodeView& fog, const glm::dmat4& world_from_node);

/// Returns a lit material, clamped to the ranges of 6.27.
[[nodiscard]] Material material_of(const NodeView& material);
/// Returns the `detail` of a QNV node, 1/100 to 100; 1 for other nodes.
[[nodiscard]] float detail_of(const NodeView& qnv);
/// Returns texture space from mesh coordinates: -C * S * R * C * T, as printed in 6.49.
[[nodiscard]] glm::mat3 texture_matrix(const NodeView& texture_transform);
/// Returns the image of an SFImage; empty if its size, components and words are inconsistent.
[[nodiscard]] Image image_of(const vrml::PixelImage& pixels);

}  // namespace gs::render
