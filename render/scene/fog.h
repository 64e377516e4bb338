#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace gs::render {

/// Bound Fog (VRML97 6.19).
struct Fog {
  glm::vec3 color{1.0f};
  bool exponential = false;  // fogType is EXPONENTIAL
  float visibility_range = 0;  // in the space of the Fog; 0 means no fog
  glm::mat3 fog_from_world{1.0f};  // without translation, because fog depends only on distance
};

/// Fog parameters of one image.
struct CameraFog {
  bool on = false, exponential = false;
  glm::vec3 color{1.0f};
  glm::mat3 ranges_from_camera{1.0f};  // to the space of the Fog, in units of visibilityRange
  float back = 0;  // Camera::back, because fog begins at the viewer
};

/// Returns the fog for a camera with the orientation `world_from_camera`. Returns no fog if a value is not finite.
[[nodiscard]] CameraFog camera_fog(const Fog& fog, const glm::mat3& world_from_camera, float back = 0);

/// Returns f0 of VRML97 Table 4.8: the weight of the object's own colour. `place` is a position in camera space.
[[nodiscard]] float fog_interpolant(const CameraFog& fog, const glm::vec3& place);

/// Applies fog to a colour at `place`, in camera space (4.14.4).
[[nodiscard]] glm::vec3 fogged(const CameraFog& fog, const glm::vec3& color, const glm::vec3& place);

}  // namespace gs::render
