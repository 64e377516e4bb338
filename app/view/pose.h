#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace gs::app {

/// Where the viewer is: world space, metres; looks along -Z of `orientation`. Always finite and normalised.
struct Pose {
  glm::dvec3 position{0, 0, 10};
  glm::quat orientation{1, 0, 0, 0};
  float field_of_view = 0.785398f;  // radians, the smaller of the two angles
  /// World units that the smaller side of the picture shows by parallel rays; 0: in perspective. Who sees by parallel
  /// rays stands where one who sees the same in perspective would.
  double height = 0;

  [[nodiscard]] glm::vec3 right() const { return orientation * glm::vec3(1, 0, 0); }
  [[nodiscard]] glm::vec3 up() const { return orientation * glm::vec3(0, 1, 0); }
  [[nodiscard]] glm::vec3 forward() const { return orientation * glm::vec3(0, 0, -1); }
};

}  // namespace gs::app
