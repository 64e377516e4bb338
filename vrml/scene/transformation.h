#pragma once

#include "vrml/scene/field_value.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace gs::vrml {

// What the nodes that move others make of their fields, for whoever draws and for sensors alike: the same fields give
// the same bits. Values that are no finite numbers count as the defaults.

/// The identity where the axis has no length, or a value is no number.
[[nodiscard]] glm::dmat3 rotation_matrix(const SFRotation& rotation);

/// parent_from_local of a Transform: T * C * R * SR * S * -SR * -C (VRML97 6.52).
[[nodiscard]] glm::dmat4 transform_matrix(const SFVec3f& translation, const SFVec3f& center, const SFRotation& rotation,
                                          const SFVec3f& scale, const SFRotation& scale_orientation);

/// parent_from_local of a Billboard seen from `viewer`, given in its parent's space like `up`, the viewer's up
/// direction (6.6). Screen alignment (axisOfRotation 0 0 0) keeps the local Y axis as near to `up` as facing the viewer
/// allows.
[[nodiscard]] glm::dmat4 billboard_matrix(const SFVec3f& axis_of_rotation, const glm::dvec3& viewer,
                                          const glm::dvec3& up = {0, 1, 0});

/// A viewer of the world in local coordinates; the origin where those have no inverse.
[[nodiscard]] glm::dvec3 viewer_in_local(const glm::dvec3& viewer, const glm::dmat4& world_from_local);

/// A direction in local coordinates; `direction` itself where those have no inverse.
[[nodiscard]] glm::dvec3 direction_in_local(const glm::dvec3& direction, const glm::dmat4& world_from_local);

/// parent_from_viewer of a Viewpoint (6.53).
[[nodiscard]] glm::dmat4 viewer_matrix(const SFVec3f& position, const SFRotation& orientation);

}  // namespace gs::vrml
