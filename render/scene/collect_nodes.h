#pragma once

#include "render/scene/collect_schema.h"
#include "render/scene/render_list.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <string_view>

// The meaning of single nodes, apart from the walk. Values outside the ranges of the standard are
// clamped, values that are no finite numbers replaced by the defaults.
namespace gs::render {

/// parent_from_local of a Transform (VRML97 6.52).
[[nodiscard]] glm::dmat4 transform_matrix(const NodeView& transform);
/// parent_from_local of a Billboard seen from `viewer`, given in its parent's space (6.6).
[[nodiscard]] glm::dmat4 billboard_matrix(const NodeView& billboard, const glm::dvec3& viewer, const glm::dvec3& up);
/// The index of the level to show, -1 for none; `viewer` in the LOD's space (6.26).
[[nodiscard]] int lod_level(const NodeView& lod, const glm::dvec3& viewer);

/// Any of the three lights in world space; radius and attenuation scaled with the transformation,
/// because the standard measures both in the light's own space (4.14.4).
[[nodiscard]] Light world_light(const NodeView& light, const glm::dmat4& world_from_node);
/// Scale is dropped from the transformation (6.53).
[[nodiscard]] ViewpointState world_viewpoint(const NodeView& viewpoint, const glm::dmat4& world_from_node);
[[nodiscard]] NavigationState navigation_state(const NodeView& navigation_info);
[[nodiscard]] Background world_background(const NodeView& background, const glm::dmat4& world_from_node,
                                          const Images& images);
/// Measured in the space of `world_from_node`; none where that has no inverse.
[[nodiscard]] Fog world_fog(const NodeView& fog, const glm::dmat4& world_from_node);

/// Lit, clamped to the ranges of 6.27.
[[nodiscard]] Material material_of(const NodeView& material);
/// The `detail` of a QNV node, 1/100 to 100; 1 of any other node.
[[nodiscard]] float detail_of(const NodeView& qnv);
/// Texture space from mesh coordinates: -C * S * R * C * T, as 6.49 prints it.
[[nodiscard]] glm::mat3 texture_matrix(const NodeView& texture_transform);
/// The picture of an SFImage; empty where its size, components and words do not fit together.
[[nodiscard]] Image image_of(const vrml::PixelImage& pixels);

}  // namespace gs::render
