#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace gs::render {

/// The bound Fog (VRML97 6.19).
struct Fog {
  glm::vec3 color{1.0f};
  bool exponential = false;        // fogType
  float visibility_range = 0;      // in the Fog's own space; 0: there is no fog
  glm::mat3 fog_from_world{1.0f};  // without the translation, which nothing depends on
};

/// The same for one picture.
struct CameraFog {
  bool on = false, exponential = false;
  glm::vec3 color{1.0f};
  glm::mat3 ranges_from_camera{1.0f};  // the Fog's own space, in visibilityRanges
  float back = 0;                      // Camera::back: fog begins at the viewer
};

/// `world_from_camera`: of the camera's axes. No fog where a number of it is none.
[[nodiscard]] CameraFog camera_fog(const Fog& fog, const glm::mat3& world_from_camera, float back = 0);

/// f0 of VRML97 Table 4.8: how much of its own colour something keeps. `place` in camera space.
[[nodiscard]] float fog_interpolant(const CameraFog& fog, const glm::vec3& place);

/// The colour of something at `place`, camera space, through the fog (4.14.4).
[[nodiscard]] glm::vec3 fogged(const CameraFog& fog, const glm::vec3& color, const glm::vec3& place);

}  // namespace gs::render
