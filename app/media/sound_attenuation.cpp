#include "app/media/sound_attenuation.h"

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

#include <cmath>

namespace gs::app {
namespace {

constexpr double kOuterDecibels = -20;  // at the outer ellipsoid, and in the limit of intensity 0

double factor_of(double decibels) { return std::pow(10, decibels / 20); }

}  // namespace

// Uses the polar form of a conic, r = p / (1 - e cos), with the focus at the origin.
double ellipsoid_radius(double front, double back, double cosine) {
  const double below = (front + back) - (front - back) * cosine;
  return below > 0 ? 2 * front * back / below : 0;
}

double intensity_factor(double intensity) {
  return intensity > 0 ? factor_of(kOuterDecibels * (1 - std::min(intensity, 1.0))) : 0;
}

// Follows Figure 7.1 of VRML97: 0.5 in front and behind, 0 at the left, 1 at the right, linear in the angle.
Pan pan_of(const glm::dvec3& viewer) {
  if (viewer.x == 0 && viewer.z == 0) return pan_of({0, 0, -1});
  double angle = std::atan2(viewer.x, -viewer.z);  // 0 is straight ahead; positive is to the right
  constexpr double kHalf = glm::half_pi<double>();
  if (angle > kHalf) angle = 2 * kHalf - angle;
  if (angle < -kHalf) angle = -2 * kHalf - angle;
  const double pan = 0.5 + angle / (2 * kHalf);
  return {1 - pan * pan, 1 - (1 - pan) * (1 - pan)};
}

Heard sound_attenuation(const render::SoundState& sound, const glm::dmat4& world_from_viewer) {
  Heard heard;
  // Affine transforms keep ratios of lengths along a line. Therefore the ratios are computed in the local space of the
  // Sound.
  const double volume = glm::determinant(glm::dmat3(sound.world_from_local));
  if (!std::isfinite(volume) || volume == 0) return heard;
  const glm::dvec3 viewer(glm::inverse(sound.world_from_local) * world_from_viewer[3]);
  const glm::dvec3 way = viewer - sound.location;
  const double distance = glm::length(way), axis = glm::length(sound.direction);
  if (!std::isfinite(distance)) return heard;
  const double cosine = distance > 0 && axis > 0 ? glm::dot(way, sound.direction) / (distance * axis) : 1;
  const double inner = ellipsoid_radius(sound.min_front, sound.min_back, cosine),
               outer = ellipsoid_radius(sound.max_front, sound.max_back, cosine);
  double decibels = 0;
  const bool is_inside = distance <= inner;
  if (!is_inside) {
    if (distance > outer) return heard;
    decibels = kOuterDecibels * (distance - inner) / (outer - inner);
  }
  heard.level = heard.left = heard.right = intensity_factor(sound.intensity) * factor_of(decibels);
  if (!sound.spatialize || is_inside) return heard;
  const glm::dvec3 place(glm::inverse(world_from_viewer) * sound.world_from_local * glm::dvec4(sound.location, 1));
  const Pan pan = pan_of(place);
  heard.left *= pan.left;
  heard.right *= pan.right;
  return heard;
}

// Orders sounds by precedence (7.3.4.1): higher priority first; then the later start if the priority exceeds 0.5; then
// the louder sound.
bool operator<(const SoundRank& a, const SoundRank& b) {
  constexpr double kCue = 0.5;
  if (a.priority != b.priority) return a.priority > b.priority;
  if (a.priority > kCue && a.start != b.start) return a.start > b.start;
  return a.level > b.level;
}

}  // namespace gs::app
