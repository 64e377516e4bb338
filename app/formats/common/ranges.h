#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace gs::app {

/// Maximum coordinate. Below it, sums of squared differences stay finite in float.
inline constexpr double kMaxCoordinate = 1e18;

/// Converts 0..1 to 0..255, rounded to the nearest integer.
[[nodiscard]] inline std::uint8_t byte_of(float value) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255));
}

}  // namespace gs::app
