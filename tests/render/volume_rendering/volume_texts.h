#pragma once

// Volumes of tests as texts in classic encoding.

#include <array>
#include <cmath>
#include <functional>
#include <string>

namespace gs::render::testing {

/// Returns a PixelTexture3D of one component. `value` gets positions in the box, 0 to 1, and returns 0 to 255.
inline std::string pixel_volume(const std::array<int, 3>& size,
                                const std::function<double(double, double, double)>& value) {
  std::string text = "PixelTexture3D { image [ 1 " + std::to_string(size[0]) + " " + std::to_string(size[1]) + " " +
                     std::to_string(size[2]);
  for (int z = 0; z < size[2]; ++z)
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x) {
        const double v = value((x + 0.5) / size[0], (y + 0.5) / size[1], (z + 0.5) / size[2]);
        text += ' ' + std::to_string(static_cast<int>(std::fmin(std::fmax(std::lround(v), 0.0), 255.0)));
      }
  return text + " ] }";
}

/// Returns a ball around the middle: 255 there, and 0 from the radius 0.5 on.
inline std::string ball_volume(int side) {
  return pixel_volume({side, side, side}, [](double x, double y, double z) {
    return 255 * (1 - 2 * std::sqrt((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) + (z - 0.5) * (z - 0.5)));
  });
}

/// Returns a volume with values that fall linearly along +Z from 255 to 0.
inline std::string ramp_volume() {
  return pixel_volume({4, 4, 32}, [](double, double, double z) { return 255 * (1 - z); });
}

}  // namespace gs::render::testing
