#pragma once

#include "render/collection/sound_state.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <vector>

namespace gs::app {

/// Audibility of a Sound for one viewer: factors >= 0 for its samples.
struct Heard {
  double level = 0;            // attenuation by intensity and distance; 0 outside the outer ellipsoid
  double left = 0, right = 0;  // per-channel factors, with panning
};

/// Returns the distance from the focus of an ellipsoid to its surface (VRML97 6.42). `front` and `back` are the
/// distances along and against its axis. `cosine` is the cosine of the angle between axis and direction.
[[nodiscard]] double ellipsoid_radius(double front, double back, double cosine);

/// Converts an intensity in 0..1 to a gain (6.42): linear in dB from -20 dB near 0 to 0 dB at 1; exactly 0 at 0.
[[nodiscard]] double intensity_factor(double intensity);

/// Stereo factors from the angle in the viewer's XZ plane between the view direction and the sound (7.3.4.2). `viewer`
/// is the sound's position in viewer coordinates; the view direction is -Z.
struct Pan {
  double left = 1, right = 1;
};
[[nodiscard]] Pan pan_of(const glm::dvec3& viewer);

/// Computes how loud a viewer hears a Sound (6.42, 7.3.4). `world_from_viewer` must have no scale.
[[nodiscard]] Heard sound_attenuation(const render::SoundState& sound, const glm::dmat4& world_from_viewer);

/// Sort key that selects which sounds play when there are more than kMaxVoices (7.3.4.1).
struct SoundRank {
  double priority = 0, start = 0, level = 0;
  friend bool operator<(const SoundRank& a, const SoundRank& b);
};

}  // namespace gs::app
