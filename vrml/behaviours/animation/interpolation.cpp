#include "vrml/behaviours/animation/interpolation.h"

#include "vrml/behaviours/animation/rotations.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace gs::vrml {
namespace {

glm::dvec4 four_of(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }

// Interpolates along the unit sphere from `a` to `b`, both unit vectors. `cosine` is the cosine of the angle between
// them.
template <class Vector>
Vector along_arc(const Vector& a, const Vector& b, double cosine, double part) {
  constexpr double kNearlyOne = 0.9999999;
  if (cosine > kNearlyOne) return glm::normalize(a + (b - a) * part);
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  return a * (std::sin((1 - part) * angle) / std::sin(angle)) + b * (std::sin(part * angle) / std::sin(angle));
}

}  // namespace

Hsv hsv_of(const SFColor& c) {
  const double r = c.r, g = c.g, b = c.b;
  const double most = std::max({r, g, b}), least = std::min({r, g, b}), range = most - least;
  Hsv result{0, most > 0 ? range / most : 0, most};
  if (!(range > 0)) return result;
  result.hue = most == r ? (g - b) / range : most == g ? 2 + (b - r) / range : 4 + (r - g) / range;
  if (result.hue < 0) result.hue += 6;
  return result;
}

SFColor color_of(const Hsv& c) {
  const double sector = std::floor(c.hue), rest = c.hue - sector;
  const double p = c.value * (1 - c.saturation), q = c.value * (1 - c.saturation * rest),
               t = c.value * (1 - c.saturation * (1 - rest));
  const auto color = [](double r, double g, double b) {
    return SFColor{static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)};
  };
  if (sector == 0) return color(c.value, t, p);
  if (sector == 1) return color(q, c.value, p);
  if (sector == 2) return color(p, c.value, t);
  if (sector == 3) return color(p, q, c.value);
  if (sector == 4) return color(t, p, c.value);
  return color(c.value, p, q);
}

KeyPlace find_key(std::span<const float> keys, float fraction) {
  const auto above = std::upper_bound(keys.begin(), keys.end(), fraction);
  if (above == keys.begin()) return {};
  const auto first = static_cast<std::size_t>(above - keys.begin()) - 1;
  if (above == keys.end()) return {first, first, 0};
  const double part = (double{fraction} - keys[first]) / (double{*above} - keys[first]);
  return part > 0 && part < 1 ? KeyPlace{first, first + 1, static_cast<float>(part)} : KeyPlace{first, first, 0};
}

float between_numbers(const float& a, const float& b, float part) {
  return static_cast<float>(a + (double{b} - a) * part);
}

SFVec3f between_points(const SFVec3f& a, const SFVec3f& b, float part) { return a + (b - a) * part; }

SFVec2f between_flat_points(const SFVec2f& a, const SFVec2f& b, float part) { return a + (b - a) * part; }

SFColor between_colors(const SFColor& a, const SFColor& b, float part) {
  Hsv from = hsv_of(a), to = hsv_of(b);
  if (from.saturation == 0) from.hue = to.hue;
  if (to.saturation == 0) to.hue = from.hue;
  double turn = to.hue - from.hue;
  if (turn > 3) turn -= 6;
  if (turn < -3) turn += 6;
  Hsv result;
  result.hue = from.hue + turn * part;
  if (result.hue < 0) result.hue += 6;
  if (result.hue >= 6) result.hue -= 6;
  result.saturation = from.saturation + (to.saturation - from.saturation) * part;
  result.value = from.value + (to.value - from.value) * part;
  return color_of(result);
}

SFVec3f between_normals(const SFVec3f& a, const SFVec3f& b, float part) {
  const glm::dvec3 from(a), to(b);
  const double lengths = glm::length(from) * glm::length(to);
  if (!(lengths > 0) || !std::isfinite(lengths)) return between_points(a, b, part);
  const glm::dvec3 first = glm::normalize(from), second = glm::normalize(to);
  const double cosine = glm::dot(first, second);
  // Opposite directions have no unique shortest path. Uses any of them.
  constexpr double kOpposite = -0.9999999;
  if (cosine < kOpposite) return SFVec3f(part < 0.5F ? first : second);
  return SFVec3f(along_arc(first, second, cosine, part));
}

SFRotation between_rotations(const SFRotation& a, const SFRotation& b, float part) {
  const glm::dvec4 from = four_of(quaternion_of(a));
  glm::dvec4 to = four_of(quaternion_of(b));
  double cosine = glm::dot(from, to);
  if (cosine < 0) {  // two quaternions represent each orientation; uses the nearer one
    to = -to;
    cosine = -cosine;
  }
  const glm::dvec4 made = along_arc(from, to, cosine, part);
  return rotation_of(glm::dquat(made.w, made.x, made.y, made.z));
}

}  // namespace gs::vrml
