#pragma once

#include "vrml/scene/field_value.h"

#include <cstddef>
#include <span>

namespace gs::vrml {

/// Where a fraction lies between keys (VRML97 4.6.8): the values of `first` and `second`, and how far on the way,
/// [0,1). 0: it is the value of `first`.
struct KeyPlace {
  std::size_t first = 0, second = 0;
  float part = 0;
};
/// Outside of the keys it is the first or the last one; where keys coincide, the last of them from there on. Keys that
/// decrease, against the standard, give some place among them. `keys` must not be empty.
[[nodiscard]] KeyPlace find_key(std::span<const float> keys, float fraction);

// `part` of the way from a to b.
[[nodiscard]] float between_numbers(const float& a, const float& b, float part);
[[nodiscard]] SFVec3f between_points(const SFVec3f& a, const SFVec3f& b, float part);
/// In HSV space, the hue by the shorter way (6.10). A colour without hue takes that of the other.
[[nodiscard]] SFColor between_colors(const SFColor& a, const SFColor& b, float part);
/// On the unit sphere (6.31); the result is a unit vector unless one of the two has no direction.
[[nodiscard]] SFVec3f between_normals(const SFVec3f& a, const SFVec3f& b, float part);
/// By the shortest way from one orientation to the other (6.32).
[[nodiscard]] SFRotation between_rotations(const SFRotation& a, const SFRotation& b, float part);

}  // namespace gs::vrml
