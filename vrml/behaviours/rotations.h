#pragma once

#include "vrml/scene/field_value.h"

#include <glm/gtc/quaternion.hpp>

namespace gs::vrml {

/// The quaternion of length 1 that turns like `rotation`. One that has no axis, or is no number, turns nothing.
[[nodiscard]] glm::dquat quaternion_of(const SFRotation& rotation);
/// An axis of length 1 and an angle from 0 to pi; where nothing is turned, `axis` and 0.
[[nodiscard]] SFRotation rotation_of(glm::dquat q, const SFVec3f& axis = {0, 0, 1});

}  // namespace gs::vrml
