#pragma once

#include "render/scene/world_bounds.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace gs::render {

/// Part of an image; the corners of the whole image are at -1 and 1.
struct PicturePart {
  double left = -1, bottom = -1, right = 1, top = 1;
  friend bool operator==(const PicturePart&, const PicturePart&) = default;
};

/// Position of the viewer and properties of the lens. World space is in metres, right-handed, Y up; the camera looks
/// along its own -Z (VRML97 4.4.5, 6.53).
struct Camera {
  glm::dmat4 world_from_camera{1.0};  // rigid: rotation and translation only
  float field_of_view = 0.785398f;    // radians, the smaller of the two angles (6.53)
  float near_plane = 0;               // metres; 0 means chosen from the bounds of the scene
  float far_plane = 0;                // metres; 0 means chosen from the bounds of the scene
  double shift = 0;                   // tangent of the image centre's offset to the right, for stereo
  PicturePart part;                   // part to draw of the image that has the field of view
  /// Parallel projection: world units along the smaller side of the image; 0 means perspective.
  double height = 0;
  double back = 0;  // far_camera: distance behind the viewer
  friend bool operator==(const Camera&, const Camera&) = default;
};

/// Returns the camera without `part`.
[[nodiscard]] Camera whole_camera(const Camera& camera);
/// Returns the size of the whole image if `size` is that of the part.
[[nodiscard]] glm::vec2 whole_size(const Camera& camera, const glm::vec2& size);

[[nodiscard]] glm::dmat4 camera_from_world_of(const Camera& camera);

/// Projection data for the rasterizers.
struct Projection {
  glm::mat4 clip_from_camera{1.0f};
  /// Same from the viewer's position, Camera::back in front of the camera, where floats resolve the visible scene.
  glm::mat4 clip_from_viewer{1.0f};
  float back = 0;  // Camera::back
  /// Reversed depth: clip space is that of GL_ZERO_TO_ONE, with depth 1 at the near and 0 at the far plane. A float
  /// depth buffer then resolves a constant fraction of the distance at any range. Otherwise clip space and depth are
  /// OpenGL's defaults.
  bool reversed = false;
  /// Window depth at distance d along the view axis is `depth_offset` + `depth_scale` / d.
  float depth_offset = 0, depth_scale = 0;

  /// Returns half of the visible extent at distance 1.
  [[nodiscard]] glm::vec2 tangents() const { return {1 / clip_from_camera[0][0], 1 / clip_from_camera[1][1]}; }
  /// Returns the centre of the visible extent at distance 1.
  [[nodiscard]] glm::vec2 center() const {
    return {clip_from_camera[2][0] / clip_from_camera[0][0], clip_from_camera[2][1] / clip_from_camera[1][1]};
  }
  [[nodiscard]] float window_depth(float distance) const { return depth_offset + depth_scale / distance; }
  [[nodiscard]] float nearest_depth() const { return reversed ? 1.0f : 0.0f; }
  [[nodiscard]] float farthest_depth() const { return reversed ? 0.0f : 1.0f; }
};

/// Returns the projection; `near_plane` and `far_plane` must be set. `width` and `height` are those of the drawn part.
[[nodiscard]] Projection projection(const Camera& camera, float width, float height, bool reversed = false);

/// Replaces a parallel projection by a perspective one from far away. Points in `bounds` deviate by at most
/// kFarParallax of the image's half side. Returns other cameras unchanged.
[[nodiscard]] Camera far_camera(const Camera& camera, const WideBox& bounds);
inline constexpr double kFarParallax = 1.0 / 4096;

/// Returns the pixels per radian at the image centre.
[[nodiscard]] float pixels_per_radian(float field_of_view, float width, float height);

/// Returns a camera at `azimuth`, `elevation` (radians; 0, 0 looks from +Z) with all of `bounds` in view.
[[nodiscard]] Camera orbit_camera(const WideBox& bounds, float azimuth, float elevation, float field_of_view,
                                  float width, float height);

/// Returns the initial view of a world without a Viewpoint: orbit_camera from +Z, or slightly above or aside if a flat
/// world would be seen edge-on.
[[nodiscard]] Camera first_camera(const WideBox& bounds, float field_of_view, float width, float height);

/// Returns the Camera::height at which all of `bounds` fits into an image of these proportions.
[[nodiscard]] double parallel_height(const Camera& camera, const WideBox& bounds, float width, float height);

/// Reports whether all of `bounds` is in front of the camera and within an image of these proportions; true for empty
/// bounds.
[[nodiscard]] bool has_in_view(const Camera& camera, const WideBox& bounds, float width, float height);

/// Returns `camera` with near and far planes that enclose `bounds` tightly for depth precision. `reversed` refers to
/// Projection::reversed and permits any near distance.
[[nodiscard]] Camera fit_depth(Camera camera, const WideBox& bounds, bool reversed = false);

}  // namespace gs::render
