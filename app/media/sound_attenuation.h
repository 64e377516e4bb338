#pragma once

#include "render/collection/nodes/sound_state.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <vector>

namespace gs::app {

/// Gains of a Sound for one viewer, each >= 0.
struct Heard {
  double level = 0;            // gain by intensity and distance; 0 outside the outer ellipsoid
  double left = 0, right = 0;  // gains of the channels: `level` with panning
};

/// Returns the distance from a focus of an ellipsoid to its surface (VRML97 6.42). `front` and `back` are that distance
/// along the axis and against it. `cosine` is the cosine of the angle between axis and direction.
[[nodiscard]] double ellipsoid_radius(double front, double back, double cosine);

/// Converts an intensity in 0..1 to a gain (6.42): linear in dB from -20 dB near 0 to 0 dB at 1; exactly 0 at 0.
[[nodiscard]] double intensity_factor(double intensity);

/// Stereo gains of a sound by its direction (7.3.4.2). pan_of() uses the angle between the view direction -Z and the
/// sound in the viewer's XZ plane. `viewer` is the sound's position in viewer space.
struct Pan {
  double left = 1, right = 1;
};
[[nodiscard]] Pan pan_of(const glm::dvec3& viewer);

/// Computes the gains of a Sound for a viewer (6.42, 7.3.4). `world_from_viewer` must have no scale.
[[nodiscard]] Heard sound_attenuation(const render::SoundState& sound, const glm::dmat4& world_from_viewer);

/// Sort key for choosing which sounds play if there are more than kMaxVoices (7.3.4.1).
struct SoundRank {
  double priority = 0, start = 0, level = 0;
  friend bool operator<(const SoundRank& a, const SoundRank& b);
};

}  // namespace gs::app
