#pragma once

#include "render/scene/world_bounds.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace gs::render {

/// A part of a picture, whose corners are at -1 and 1.
struct PicturePart {
  double left = -1, bottom = -1, right = 1, top = 1;
  friend bool operator==(const PicturePart&, const PicturePart&) = default;
};

/// Where the viewer is and what the lens sees. World space is metres, right-handed, Y up; the camera
/// looks along its own -Z (VRML97 4.4.5, 6.53).
struct Camera {
  glm::dmat4 world_from_camera{1.0};  // rigid: rotation and translation only
  float field_of_view = 0.785398f;    // radians, the smaller of the two angles (6.53)
  float near_plane = 0;               // metres; 0: chosen from the bounds of what is drawn
  float far_plane = 0;                // metres; 0: likewise
  double shift = 0;  // tangent of how far to the right the middle of the picture lies: of eyes that see in stereo
  PicturePart part;  // that is drawn, of the picture that has the field of view
  /// World units that the smaller side of the picture shows by parallel rays; 0: in perspective.
  double height = 0;
  double back = 0;  // of far_camera: how far behind the viewer it is
  friend bool operator==(const Camera&, const Camera&) = default;
};

/// The same without `part`.
[[nodiscard]] Camera whole_camera(const Camera& camera);
/// The size of the picture, of which `size` has the part.
[[nodiscard]] glm::vec2 whole_size(const Camera& camera, const glm::vec2& size);

[[nodiscard]] glm::dmat4 camera_from_world_of(const Camera& camera);

/// What the rasteriser needs of a lens.
struct Projection {
  glm::mat4 clip_from_camera{1.0f};
  /// The same from where the viewer is, who has Camera::back before him: there floats resolve what he sees.
  glm::mat4 clip_from_viewer{1.0f};
  float back = 0;  // of the camera
  /// Clip space is that of GL_ZERO_TO_ONE, depth 1 is the near plane and 0 the far one, so that a depth buffer of
  /// floats resolves a constant part of the distance however far it reaches. Else clip space and depth are OpenGL's
  /// own.
  bool reversed = false;
  /// The depth of the window at a distance d along the view axis is `depth_offset` + `depth_scale` / d.
  float depth_offset = 0, depth_scale = 0;

  /// Half of what is seen at a distance of one, and the middle of that.
  [[nodiscard]] glm::vec2 tangents() const { return {1 / clip_from_camera[0][0], 1 / clip_from_camera[1][1]}; }
  [[nodiscard]] glm::vec2 center() const {
    return {clip_from_camera[2][0] / clip_from_camera[0][0], clip_from_camera[2][1] / clip_from_camera[1][1]};
  }
  [[nodiscard]] float window_depth(float distance) const { return depth_offset + depth_scale / distance; }
  [[nodiscard]] float nearest_depth() const { return reversed ? 1.0f : 0.0f; }
  [[nodiscard]] float farthest_depth() const { return reversed ? 0.0f : 1.0f; }
};

/// `near_plane` and `far_plane` must be set. `width`, `height`: of what is drawn.
[[nodiscard]] Projection projection(const Camera& camera, float width, float height, bool reversed = false);

/// Of a camera with parallel rays one in perspective that sees the same from so far away that what lies within `bounds`
/// is at most kFarParallax of the picture's half side from where it should be; others as they are.
[[nodiscard]] Camera far_camera(const Camera& camera, const WorldBounds& bounds);
inline constexpr double kFarParallax = 1.0 / 4096;

/// How many pixels an angle of one radian has in the middle of the picture.
[[nodiscard]] float pixels_per_radian(float field_of_view, float width, float height);

/// A camera at `azimuth`, `elevation` (radians; 0, 0 looks from +Z) that has the whole of `bounds` in view.
[[nodiscard]] Camera orbit_camera(const WorldBounds& bounds, float azimuth, float elevation, float field_of_view,
                                  float width, float height);

/// Where a world without a Viewpoint is first seen from: orbit_camera from +Z, or from somewhat above or
/// aside where the world is so flat that it would be seen edge on.
[[nodiscard]] Camera first_camera(const WorldBounds& bounds, float field_of_view, float width, float height);

/// The Camera::height by which all of `bounds` is within the sides of a picture of these proportions.
[[nodiscard]] double parallel_height(const Camera& camera, const WorldBounds& bounds, float width, float height);

/// True when all of `bounds` is within the sides of a picture of these proportions, and before the camera; of no bounds
/// all is.
[[nodiscard]] bool has_in_view(const Camera& camera, const WorldBounds& bounds, float width, float height);

/// `camera` with near and far planes that enclose `bounds` as tightly as depth precision wants. `reversed`: for
/// Projection::reversed, which lets the viewer come as near as wanted.
[[nodiscard]] Camera fit_depth(Camera camera, const WorldBounds& bounds, bool reversed = false);

}  // namespace gs::render
