#pragma once

#include "qnv/base/cloud.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

/// The colours that tell the vectors of a stream apart (ColorBy): display-referred sRGB, the same for discs and voxels.
namespace gs::render {

/// A fully saturated hue, of `value` 0..1 in brightness: 0 red, 1/3 green, 2/3 blue, 1 red again. Of numbers beyond
/// that the fraction counts; no number at all is red.
[[nodiscard]] inline qnv::Rgb8 hue_color(double hue, double value = 1) {
  hue = std::isfinite(hue) ? (hue - std::floor(hue)) * 6 : 0;
  const auto level = [&](double center) {  // 1 within a sixth of the circle about it, 0 from a third on
    const double away = std::min(std::abs(hue - center), 6 - std::abs(hue - center));
    return static_cast<std::uint8_t>(std::lround(std::clamp((2 - away) * value, 0.0, value) * 255));
  };
  return {level(0), level(2), level(4)};
}

/// From blue (0) over cyan, green and yellow to red (1).
[[nodiscard]] inline qnv::Rgb8 ramp_color(double part) {
  return hue_color((1 - (part >= 0 ? std::min(part, 1.0) : 0.0)) * (2.0 / 3));
}

/// Of a level of detail: 0 is blue, `deepest` and what lies beyond red.
[[nodiscard]] inline qnv::Rgb8 level_color(unsigned level, unsigned deepest) {
  return ramp_color(deepest == 0 ? 1.0 : static_cast<double>(level) / static_cast<double>(deepest));
}

/// Of a chunk: hues a golden section of the circle apart, so that neighbours in number differ most.
[[nodiscard]] inline qnv::Rgb8 chunk_color(std::uint32_t number) {
  constexpr double kGolden = 0.618033988749894848;
  return hue_color(static_cast<double>(number) * kGolden, number % 2 == 0 ? 1.0 : 0.75);
}

/// 0: came first, blue; 1: last, red.
[[nodiscard]] inline qnv::Rgb8 age_color(double age) { return ramp_color(age); }

// Clouds without levels lie in progressive order: the more of them, the finer. What stands for levels and chunks there:

/// The octave of a vector: 0 for the first kFirstOctave, then one more for every doubling.
inline constexpr std::size_t kFirstOctave = 64;
[[nodiscard]] inline unsigned octave_of(std::size_t index) {
  unsigned octave = 0;
  for (std::size_t end = kFirstOctave; index >= end && octave < 63; ++octave)
    end = end > SIZE_MAX / 2 ? SIZE_MAX : end * 2;
  return octave;
}
/// Vectors a block.
inline constexpr std::size_t kBlockVectors = 4096;

}  // namespace gs::render
