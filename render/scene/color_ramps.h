#pragma once

#include "qnv/base/description.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

/// Colours that distinguish the vectors of a stream (ColorBy), in sRGB for display. Splats and voxels use the same
/// colours.
namespace gs::render {

/// Returns a fully saturated colour. `hue` 0 is red, 1/3 green, 2/3 blue, 1 red again; only its fraction counts.
/// `value` is the brightness, 0 to 1. Returns red if `hue` is not finite.
[[nodiscard]] inline qnv::Rgb8 hue_color(double hue, double value = 1) {
  hue = std::isfinite(hue) ? (hue - std::floor(hue)) * 6 : 0;
  const auto level = [&](double center) {  // 1 up to a sixth of the colour circle from `center`, 0 from a third on
    const double away = std::min(std::abs(hue - center), 6 - std::abs(hue - center));
    return static_cast<std::uint8_t>(std::lround(std::clamp((2 - away) * value, 0.0, value) * 255));
  };
  return {level(0), level(2), level(4)};
}

/// Returns a colour of a ramp: blue (0), cyan, green, yellow, red (1).
[[nodiscard]] inline qnv::Rgb8 ramp_color(double part) {
  return hue_color((1 - (part >= 0 ? std::min(part, 1.0) : 0.0)) * (2.0 / 3));
}

/// Returns the colour of a level of detail: 0 is blue; `deepest` and deeper levels are red.
[[nodiscard]] inline qnv::Rgb8 level_color(unsigned level, unsigned deepest) {
  return ramp_color(deepest == 0 ? 1.0 : static_cast<double>(level) / static_cast<double>(deepest));
}

/// Returns the colour of a chunk. The hues of successive chunks are a golden section of the circle apart, so that they
/// differ strongly.
[[nodiscard]] inline qnv::Rgb8 chunk_color(std::uint32_t number) {
  constexpr double kGolden = 0.618033988749894848;
  return hue_color(static_cast<double>(number) * kGolden, number % 2 == 0 ? 1.0 : 0.75);
}

/// Returns the colour of an order of receipt: 0 (first) is blue, 1 (last) is red.
[[nodiscard]] inline qnv::Rgb8 age_color(double age) { return ramp_color(age); }

// In geometries without levels, the vectors are in progressive order. There, octaves of this order replace levels, and
// blocks replace chunks.

/// Octave of a vector. Octave 0 has the first kFirstOctave vectors; each further octave doubles the number so far.
inline constexpr std::size_t kFirstOctave = 64;
[[nodiscard]] inline unsigned octave_of(std::size_t index) {
  unsigned octave = 0;
  for (std::size_t end = kFirstOctave; index >= end && octave < 63; ++octave)
    end = end > SIZE_MAX / 2 ? SIZE_MAX : end * 2;
  return octave;
}
/// Vectors of a block.
inline constexpr std::size_t kBlockVectors = 4096;

}  // namespace gs::render
