#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gs::app {

/// Squares of differences of such coordinates are still finite floats.
inline constexpr double kMostCoordinate = 1e18;

/// 0..1 as 0..255, to the nearest.
[[nodiscard]] inline std::uint8_t byte_of(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

}  // namespace gs::app
