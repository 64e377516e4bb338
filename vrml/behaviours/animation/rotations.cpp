#include "vrml/behaviours/animation/rotations.h"

#include <glm/glm.hpp>

#include <cmath>

namespace gs::vrml {

glm::dquat quaternion_of(const SFRotation& rotation) {
  const glm::dvec3 axis(rotation.x, rotation.y, rotation.z);
  const double length = glm::length(axis), half = rotation.angle * 0.5;
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(half)) return {1, 0, 0, 0};
  return {std::cos(half), axis * (std::sin(half) / length)};
}

SFRotation rotation_of(glm::dquat q, const SFVec3f& axis) {
  q = glm::normalize(q);
  if (q.w < 0) q = -q;
  const double sine = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(sine > 0)) return {axis.x, axis.y, axis.z, 0};
  return {static_cast<float>(q.x / sine), static_cast<float>(q.y / sine), static_cast<float>(q.z / sine),
          static_cast<float>(2 * std::atan2(sine, q.w))};
}

}  // namespace gs::vrml
