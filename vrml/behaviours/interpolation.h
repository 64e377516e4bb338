#pragma once

#include "vrml/scene/field_value.h"

#include <cstddef>
#include <span>

namespace gs::vrml {

/// Position of a fraction between two keys (VRML97 4.6.8): indices of the two key values, and the weight of the second
/// one in [0,1). A `part` of 0 means exactly the value of `first`.
struct KeyPlace {
  std::size_t first = 0, second = 0;
  float part = 0;
};
/// Returns the position of `fraction`. Outside the keys, it is that of the first or last key; at coinciding keys, that
/// of the last one. Decreasing keys, which the standard forbids, give some valid position. `keys` must not be empty.
[[nodiscard]] KeyPlace find_key(std::span<const float> keys, float fraction);

// Interpolates linearly: returns a + part * (b - a).
[[nodiscard]] float between_numbers(const float& a, const float& b, float part);
[[nodiscard]] SFVec3f between_points(const SFVec3f& a, const SFVec3f& b, float part);
/// Interpolates in HSV space; the hue takes the shorter way (6.10). A colour without hue takes the other colour's hue.
[[nodiscard]] SFColor between_colors(const SFColor& a, const SFColor& b, float part);
/// Interpolates on the unit sphere (6.31). The result is a unit vector unless one argument has no direction.
[[nodiscard]] SFVec3f between_normals(const SFVec3f& a, const SFVec3f& b, float part);
/// Interpolates along the shortest path between two orientations (6.32).
[[nodiscard]] SFRotation between_rotations(const SFRotation& a, const SFRotation& b, float part);

}  // namespace gs::vrml
