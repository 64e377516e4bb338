#pragma once

#include "vrml/scene/values/field_value.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace gs::vrml {

// Matrices of transforming nodes. Rendering and sensors share them, so that equal fields give equal bits. Values that
// are not finite count as the defaults.

/// Returns the rotation as a matrix. Returns the identity if the axis has no length or a value is not finite.
[[nodiscard]] glm::dmat3 rotation_matrix(const SFRotation& rotation);

/// Returns parent_from_local of a Transform: T * C * R * SR * S * -SR * -C (VRML97 6.52).
[[nodiscard]] glm::dmat4 transform_matrix(const SFVec3f& translation, const SFVec3f& center, const SFRotation& rotation,
                                          const SFVec3f& scale, const SFRotation& scale_orientation);

/// Returns parent_from_local of a Billboard (6.6). `viewer` is the position of the viewer and `up` its up direction, in
/// the space of the parent. Screen alignment (axisOfRotation 0 0 0) turns the local Y axis as close to `up` as possible
/// while the Billboard faces the viewer.
[[nodiscard]] glm::dmat4 billboard_matrix(const SFVec3f& axis_of_rotation, const glm::dvec3& viewer,
                                          const glm::dvec3& up = {0, 1, 0});

/// Transforms the position of a viewer from world to local space. Returns the origin if the matrix is singular.
[[nodiscard]] glm::dvec3 viewer_in_local(const glm::dvec3& viewer, const glm::dmat4& world_from_local);

/// Transforms a direction from world to local space. Returns `direction` if the matrix is singular.
[[nodiscard]] glm::dvec3 direction_in_local(const glm::dvec3& direction, const glm::dmat4& world_from_local);

/// Returns parent_from_viewer of a Viewpoint (6.53).
[[nodiscard]] glm::dmat4 viewer_matrix(const SFVec3f& position, const SFRotation& orientation);

}  // namespace gs::vrml
