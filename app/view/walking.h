#pragma once

#include "render/rays/item_bvh.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace gs::app {

/// The viewer's body (VRML97 6.29, avatarSize), in world units: an upright capsule of `radius` from what it steps over
/// to the eye. All are above 0.
struct Avatar {
  double radius = 0.25, height = 1.6, step = 0.75;  // `height`: of the eye above the ground
  glm::dvec3 up{0, 1, 0};                           // of length 1
  bool gravity = true;                              // WALK: it stands on the ground. FLY: it does not
};

/// What a body may meet.
struct Obstacles {
  /// Triangles that may touch a box of world space.
  std::function<std::vector<render::WorldTriangle>(const glm::dvec3& lower, const glm::dvec3& upper)> near;
  /// How far away the first triangle is along a half line whose direction is of length 1.
  std::function<std::optional<double>(const glm::dvec3& origin, const glm::dvec3& direction)> distance;
};

/// A body on its way.
struct Walk {
  glm::dvec3 eye{0};                // where it is, were it not for `lag`
  double falling = 0;               // world units a second, downwards
  bool on_ground = false;           // it stands on something
  double lag = 0;                   // how far what is seen has yet to rise (below 0: to sink) after a step
  std::optional<std::size_t> item;  // that it met, the last one

  /// Whether it goes on without being moved.
  [[nodiscard]] bool moving() const { return falling != 0 || lag != 0; }
  /// Where it sees from.
  [[nodiscard]] glm::dvec3 seen_from(const Avatar& avatar) const { return eye - avatar.up * lag; }
};

/// The body after it was to go by `way` in `seconds`: it slides along what it meets, steps over what is no higher than
/// avatar.step, follows the ground and falls onto it, where there is any (VRML97 4.13.4, 6.29). What it stood in at the
/// start, as where a Viewpoint was put into a wall, lets it go, but not deeper. The same at all rates of frames, as far
/// as paths that are cut into pieces of half a radius are. A piece of way behind kMostPieces is left out. Pure, but for
/// what `obstacles` does; safe for any numbers.
[[nodiscard]] Walk walk(const Walk& from, const Avatar& avatar, const Obstacles& obstacles, const glm::dvec3& way,
                        double seconds);
inline constexpr int kMostPieces = 256;

}  // namespace gs::app
