#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>

namespace gs::app {

// Changes of the signs of the axes: `axes` has a 1 or a -1 for each of x, y and z.

/// Returns the rotation of a splat's axes after the change. The quaternion is x, y, z, w.
[[nodiscard]] inline glm::vec4 turned(const glm::vec4& q, const glm::vec3& axes) {
  return {q.x * axes.y * axes.z, q.y * axes.x * axes.z, q.z * axes.x * axes.y, q.w};
}

/// Returns the factors of the coefficients of spherical harmonics of degrees 1 to 3.
[[nodiscard]] inline std::array<float, 15> harmonic_signs(const glm::vec3& axes) {
  const float x = axes.x, y = axes.y, z = axes.z;
  return {y, z, x, x * y, y * z, 1, x * z, 1, y, x * y * z, y, z, x, z, x};
}

}  // namespace gs::app
