#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace gs::app {

/// Viewer pose in world space (metres); the view direction is -Z of `orientation`. Always finite and normalised.
struct Pose {
  glm::dvec3 position{0, 0, 10};
  glm::quat orientation{1, 0, 0, 0};
  float field_of_view = 0.785398f;  // radians, the smaller of the two angles
  /// World units shown along the picture's smaller side in parallel projection; 0 means perspective. The position of a
  /// parallel view is that of a perspective view with the same content.
  double height = 0;

  [[nodiscard]] glm::vec3 right() const { return orientation * glm::vec3(1, 0, 0); }
  [[nodiscard]] glm::vec3 up() const { return orientation * glm::vec3(0, 1, 0); }
  [[nodiscard]] glm::vec3 forward() const { return orientation * glm::vec3(0, 0, -1); }
};

}  // namespace gs::app
