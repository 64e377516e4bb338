#pragma once

#include "vrml/scene/values/field_value.h"

#include <cstddef>
#include <span>

namespace gs::vrml {

/// Colour as hue, saturation and value.
struct Hsv {
  double hue = 0, saturation = 0, value = 0;  // hue in sixths of the colour circle, [0,6)
};
[[nodiscard]] Hsv hsv_of(const SFColor& color);
[[nodiscard]] SFColor color_of(const Hsv& color);

/// Position of a fraction between two keys (VRML97 4.6.8): indices of the two key values, and the weight of the second
/// value in [0,1). If `part` is 0, the result is exactly the value of `first`.
struct KeyPlace {
  std::size_t first = 0, second = 0;
  float part = 0;
};
/// Returns the position of `fraction` among the keys. Below the first key, returns the position of the first key; above
/// the last key, that of the last key. If keys are equal, returns that of the last of them. Decreasing keys, which the
/// standard forbids, give some valid position. `keys` must not be empty.
[[nodiscard]] KeyPlace find_key(std::span<const float> keys, float fraction);

// Interpolates linearly: returns a + part * (b - a).
[[nodiscard]] float between_numbers(const float& a, const float& b, float part);
[[nodiscard]] SFVec3f between_points(const SFVec3f& a, const SFVec3f& b, float part);
[[nodiscard]] SFVec2f between_flat_points(const SFVec2f& a, const SFVec2f& b, float part);
/// Interpolates in HSV space; the hue takes the shorter way around the circle (6.10). A colour without hue gets the hue
/// of the other colour.
[[nodiscard]] SFColor between_colors(const SFColor& a, const SFColor& b, float part);
/// Interpolates along the unit sphere (6.31). The result is a unit vector, unless an argument has no direction.
[[nodiscard]] SFVec3f between_normals(const SFVec3f& a, const SFVec3f& b, float part);
/// Interpolates along the shortest path between two orientations (6.32).
[[nodiscard]] SFRotation between_rotations(const SFRotation& a, const SFRotation& b, float part);

}  // namespace gs::vrml
