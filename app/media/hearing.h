#pragma once

#include "render/scene/sound_state.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <vector>

namespace gs::app {

/// What is heard of a Sound: factors of its samples, 0 and more.
struct Heard {
  double level = 0;            // of intensity and distance: 0 outside of the outer ellipsoid
  double left = 0, right = 0;  // with panning
};

/// From the focus of an ellipsoid to its surface (VRML97 6.42): `front` and `back` are the distances from there along
/// and against its axis, `cosine` that of the angle between the axis and the way.
[[nodiscard]] double ellipsoid_radius(double front, double back, double cosine);

/// The factor of a loudness between 0 and 1: -20 dB towards 0, 0 dB at 1, linear in dB between; 0 at 0 (6.42).
[[nodiscard]] double intensity_factor(double intensity);

/// Left and right, by the angle in the viewer's XZ plane between straight ahead and the sound (7.3.4.2). `viewer`: the
/// sound's place in the viewer's coordinates, where he looks along -Z.
struct Pan {
  double left = 1, right = 1;
};
[[nodiscard]] Pan pan_of(const glm::dvec3& viewer);

/// What a viewer hears of a Sound (6.42, 7.3.4). `world_from_viewer` without scale.
[[nodiscard]] Heard hear(const render::SoundState& sound, const glm::dmat4& world_from_viewer);

/// What decides which sounds are played where not all can be (7.3.4.1).
struct SoundRank {
  double priority = 0, start = 0, level = 0;
  friend bool operator<(const SoundRank& a, const SoundRank& b);
};

}  // namespace gs::app
