#pragma once

#include "vrml/scene/values/field_value.h"

#include <glm/gtc/quaternion.hpp>

namespace gs::vrml {

/// Returns the unit quaternion of `rotation`. Returns the identity if the axis has no length or a component is not
/// finite.
[[nodiscard]] glm::dquat quaternion_of(const SFRotation& rotation);
/// Returns the rotation of `q` as a unit axis and an angle from 0 to pi. If `q` is the identity, returns `axis` and 0.
[[nodiscard]] SFRotation rotation_of(glm::dquat q, const SFVec3f& axis = {0, 0, 1});

}  // namespace gs::vrml
