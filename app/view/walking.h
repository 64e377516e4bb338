#pragma once

#include "render/rays/item_bvh.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace gs::app {

/// Viewer's body (VRML97 6.29, avatarSize) in world units: an upright capsule of `radius` from step height to eye
/// height. All values are > 0.
struct Avatar {
  double radius = 0.25, height = 1.6, step = 0.75;  // `height` is the eye height above ground
  glm::dvec3 up{0, 1, 0};                           // unit length
  bool gravity = true;                              // true in WALK, false in FLY
};

/// Collision queries for a body.
struct Obstacles {
  /// Returns the triangles that may touch a world-space box.
  std::function<std::vector<render::WorldTriangle>(const glm::dvec3& lower, const glm::dvec3& upper)> near;
  /// Returns the distance to the first triangle along a half line; `direction` has unit length.
  std::function<std::optional<double>(const glm::dvec3& origin, const glm::dvec3& direction)> distance;
};

/// State of a moving body.
struct Walk {
  glm::dvec3 eye{0};                // position without `lag`
  double falling = 0;               // world units per second, downwards
  bool on_ground = false;           // stands on a surface
  double lag = 0;                   // height that the view has yet to rise (negative: sink) after a step
  std::optional<std::size_t> item;  // last item that it collided with

  /// Reports whether it moves without input.
  [[nodiscard]] bool moving() const { return falling != 0 || lag != 0; }
  /// Returns the eye position to draw from.
  [[nodiscard]] glm::dvec3 seen_from(const Avatar& avatar) const { return eye - avatar.up * lag; }
};

/// Moves the body by `way` in `seconds`. It slides along obstacles, climbs steps up to avatar.step, follows the ground
/// and falls onto it (VRML97 4.13.4, 6.29). If it starts inside an obstacle, such as a Viewpoint in a wall, it can
/// leave but not go deeper. The result is independent of the frame rate as far as paths cut into half-radius pieces
/// are. Drops pieces over kMaxPieces. Pure, apart from `obstacles`; safe for any numbers.
[[nodiscard]] Walk walk(const Walk& from, const Avatar& avatar, const Obstacles& obstacles, const glm::dvec3& way,
                        double seconds);
inline constexpr int kMaxPieces = 256;

}  // namespace gs::app
