#pragma once

#include "vrml/mesh/mesh.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace gs::render {

/// Where the viewer is and what the lens sees. World space is metres, right-handed, Y up; the camera
/// looks along its own -Z (VRML97 4.4.5, 6.53).
struct Camera {
  glm::mat4 world_from_camera{1.0f};  // rigid: rotation and translation only
  float field_of_view = 0.785398f;    // radians, the smaller of the two angles (6.53)
  float near_plane = 0;               // metres; 0: chosen from the bounds of what is drawn
  float far_plane = 0;                // metres; 0: likewise
};

/// In double precision: the difference of two large coordinates must survive.
[[nodiscard]] glm::dmat4 camera_from_world_of(const Camera& camera);

/// Clip space of OpenGL from camera space. `near_plane` and `far_plane` must be set.
[[nodiscard]] glm::mat4 projection(const Camera& camera, float width, float height);

/// How many pixels an angle of one radian has in the middle of the picture.
[[nodiscard]] float pixels_per_radian(float field_of_view, float width, float height);

/// A camera at `azimuth`, `elevation` (radians; 0, 0 looks from +Z) that has the whole of `bounds` in view.
[[nodiscard]] Camera orbit_camera(const vrml::Bounds& bounds, float azimuth, float elevation, float field_of_view,
                                  float width, float height);

/// Where a world without a Viewpoint is first seen from: orbit_camera from +Z, or from somewhat above where
/// the world is so flat that it would be seen edge on.
[[nodiscard]] Camera first_camera(const vrml::Bounds& bounds, float field_of_view, float width, float height);

/// `camera` with near and far planes that enclose `bounds` as tightly as depth precision wants.
[[nodiscard]] Camera fit_depth(Camera camera, const vrml::Bounds& bounds);

}  // namespace gs::render
