#pragma once

#include "render/scene/world_bounds.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace gs::render {

/// Rectangle of an image to draw. The corners of the whole image are at -1 and 1.
struct PicturePart {
  double left = -1, bottom = -1, right = 1, top = 1;
  friend bool operator==(const PicturePart&, const PicturePart&) = default;
};

/// Position and orientation of the viewer, and lens. World space is in metres, right-handed, Y up. The camera looks
/// along its own -Z (VRML97 4.4.5, 6.53).
struct Camera {
  glm::dmat4 world_from_camera{1.0};  // rotation and translation only
  float field_of_view = 0.785398f;  // radians, along the smaller side of the image (6.53)
  float near_plane = 0;  // metres; 0 means derived from the bounds of the scene
  float far_plane = 0;  // metres; 0 means derived from the bounds of the scene
  double shift = 0;  // for stereo: tangent of the shift of the image centre to the right
  PicturePart part;  // part of the whole image to draw
  /// World units along the smaller side of the image in parallel projection. 0 means perspective.
  double height = 0;
  double back = 0;  // set by far_camera(): distance of the camera behind the viewer, world units
  friend bool operator==(const Camera&, const Camera&) = default;
};

/// Returns the camera for the whole image, without `part`.
[[nodiscard]] Camera whole_camera(const Camera& camera);
/// Returns the size of the whole image. `size` is the size of the part.
[[nodiscard]] glm::vec2 whole_size(const Camera& camera, const glm::vec2& size);

[[nodiscard]] glm::dmat4 camera_from_world_of(const Camera& camera);

/// Projection data for the rasterizers.
struct Projection {
  glm::mat4 clip_from_camera{1.0f};
  /// clip_from_camera for positions relative to the viewer, Camera::back in front of the camera. Floats resolve the
  /// visible scene there.
  glm::mat4 clip_from_viewer{1.0f};
  float back = 0;  // Camera::back of the camera
  /// Reversed depth: clip space as with GL_ZERO_TO_ONE, with depth 1 at the near plane and 0 at the far plane. A float
  /// depth buffer then has a constant relative precision at any distance. Otherwise, clip space and depth are OpenGL's
  /// defaults.
  bool reversed = false;
  /// Window depth at distance d along the view axis is depth_offset + depth_scale / d.
  float depth_offset = 0, depth_scale = 0;

  /// Returns half of the visible width and height at distance 1.
  [[nodiscard]] glm::vec2 tangents() const { return {1 / clip_from_camera[0][0], 1 / clip_from_camera[1][1]}; }
  /// Returns the centre of the visible rectangle at distance 1.
  [[nodiscard]] glm::vec2 center() const {
    return {clip_from_camera[2][0] / clip_from_camera[0][0], clip_from_camera[2][1] / clip_from_camera[1][1]};
  }
  [[nodiscard]] float window_depth(float distance) const { return depth_offset + depth_scale / distance; }
  [[nodiscard]] float nearest_depth() const { return reversed ? 1.0f : 0.0f; }
  [[nodiscard]] float farthest_depth() const { return reversed ? 0.0f : 1.0f; }
};

/// Returns the projection of a camera with near and far planes. `width` and `height` are the pixels of the drawn part.
[[nodiscard]] Projection projection(const Camera& camera, float width, float height, bool reversed = false);

/// Replaces a parallel projection by a perspective projection from far away. Points in `bounds` move by at most
/// kFarParallax of half the image's side. Returns other cameras unchanged.
[[nodiscard]] Camera far_camera(const Camera& camera, const WideBox& bounds);
inline constexpr double kFarParallax = 1.0 / 4096;

/// Returns the pixels per radian at the image centre.
[[nodiscard]] float pixels_per_radian(float field_of_view, float width, float height);

/// Returns a camera with all of `bounds` in view. Its direction is given by `azimuth` and `elevation` in radians; 0, 0
/// looks from +Z.
[[nodiscard]] Camera orbit_camera(const WideBox& bounds, float azimuth, float elevation, float field_of_view,
                                  float width, float height);

/// Returns the initial camera of a world without a Viewpoint: orbit_camera() from +Z. If that would show a flat world
/// edge-on, looks from slightly above or from the side.
[[nodiscard]] Camera first_camera(const WideBox& bounds, float field_of_view, float width, float height);

/// Returns the smallest Camera::height for which all of `bounds` fits into an image of `width` to `height`.
[[nodiscard]] double parallel_height(const Camera& camera, const WideBox& bounds, float width, float height);

/// Reports whether all of `bounds` is in front of the camera and inside an image of `width` to `height`. Returns true
/// for empty bounds.
[[nodiscard]] bool has_in_view(const Camera& camera, const WideBox& bounds, float width, float height);

/// Returns the camera with near and far planes close around `bounds`, for precise depth. `reversed` means
/// Projection::reversed, which permits any near distance.
[[nodiscard]] Camera fit_depth(Camera camera, const WideBox& bounds, bool reversed = false);

}  // namespace gs::render
