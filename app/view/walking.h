#pragma once

#include "render/rays/item_bvh.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace gs::app {

/// Body of the viewer in world units (VRML97 6.29, avatarSize). It is an upright capsule of `radius`, from the step
/// height to the eye height. All sizes are > 0.
struct Avatar {
  double radius = 0.25, height = 1.6, step = 0.75;  // `height` is the height of the eye above the ground
  glm::dvec3 up{0, 1, 0};                           // up direction, unit length
  bool gravity = true;                              // true in WALK, false in FLY
  bool solid = true;                                // obstacles stop the viewer; false also turns gravity off
};

/// Obstacles around the viewer, as search functions.
struct Obstacles {
  /// Returns all triangles that may touch a box in world space.
  std::function<std::vector<render::WorldTriangle>(const glm::dvec3& lower, const glm::dvec3& upper)> near;
  /// Returns the distance to the first triangle along a half-line; nullopt if there is none. `direction` has unit
  /// length.
  std::function<std::optional<double>(const glm::dvec3& origin, const glm::dvec3& direction)> distance;
};

/// State of the viewer's body between movements.
struct Walk {
  glm::dvec3 eye{0};                // position of the eye without `lag`
  double falling = 0;               // world units/s; speed of falling
  bool on_ground = false;           // the body stands on a surface
  double lag = 0;                   // world units; height that the view must still rise (negative: sink) after a step
  std::optional<std::size_t> item;  // index of the item that the body touched last

  /// Reports whether the body will move without further input.
  [[nodiscard]] bool moving() const { return falling != 0 || lag != 0; }
  /// Returns the position of the eye for drawing.
  [[nodiscard]] glm::dvec3 seen_from(const Avatar& avatar) const { return eye - avatar.up * lag; }
};

/// Moves the body by `way` in `seconds` (VRML97 4.13.4, 6.29). It slides along obstacles, climbs steps up to
/// `avatar.step`, follows the ground, and falls onto it. If the body starts inside an obstacle, for example at a
/// Viewpoint in a wall, it can leave but not go deeper. Long ways are divided into pieces of half a radius, so that the
/// result hardly depends on the frame rate; pieces beyond kMaxPieces are dropped, unless
/// the line is free. Pure, apart from `obstacles`. Safe
/// for any numbers.
[[nodiscard]] Walk walk(const Walk& from, const Avatar& avatar, const Obstacles& obstacles, const glm::dvec3& way,
                        double seconds);
inline constexpr int kMaxPieces = 256;

}  // namespace gs::app
