#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace gs::app {

/// Pose of the viewer in world space, in metres. The view direction is -Z of `orientation`. All numbers are finite, and
/// `orientation` is normalised.
struct Pose {
  glm::dvec3 position{0, 0, 10};
  glm::quat orientation{1, 0, 0, 0};
  float field_of_view = 0.785398f;  // radians, along the smaller side of the picture
  /// Height of a parallel projection: world units along the smaller side of the picture. 0 means a perspective
  /// projection. The position in a parallel projection is that of a perspective view with the same content.
  double height = 0;

  [[nodiscard]] glm::vec3 right() const { return orientation * glm::vec3(1, 0, 0); }
  [[nodiscard]] glm::vec3 up() const { return orientation * glm::vec3(0, 1, 0); }
  [[nodiscard]] glm::vec3 forward() const { return orientation * glm::vec3(0, 0, -1); }
};

}  // namespace gs::app
