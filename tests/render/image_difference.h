#pragma once

#include "render/image/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <variant>

namespace gs::render {

/// Difference of two images of equal size over all components; PSNR in dB (infinite if equal).
struct ImageDifference {
  double maximum = 0, mean = 0, psnr = 0;
  std::size_t differing_pixels = 0;
};

inline bool well_formed(const Image& image) {
  return image.components >= 1 && image.components <= 4 &&
         image.pixels.size() == std::uint64_t{image.width} * image.height * image.components;
}

inline std::array<std::uint8_t, 4> rgba(const Image& image, std::size_t pixel) {
  const std::uint8_t* p = image.pixels.data() + pixel * image.components;
  switch (image.components) {
    case 1:
      return {p[0], p[0], p[0], 255};
    case 2:
      return {p[0], p[0], p[0], p[1]};
    case 3:
      return {p[0], p[1], p[2], 255};
    default:
      return {p[0], p[1], p[2], p[3]};
  }
}

/// Compares two images. Images with different components are compared as RGBA, opaque without alpha.
[[nodiscard]] inline std::variant<ImageDifference, ImageError> compare(const Image& a, const Image& b) {
  for (const Image* image : {&a, &b})
    if (!well_formed(*image)) return ImageError{"not a whole image"};
  if (a.width != b.width || a.height != b.height) return ImageError{"pictures of different size"};

  ImageDifference difference;
  // Different formats are compared by their appearance as RGBA, opaque without alpha.
  const bool alike = a.components == b.components;
  const std::size_t components = alike ? a.components : 4;
  const std::size_t pixels = std::size_t{a.width} * a.height;
  std::uint64_t sum = 0, squares = 0;
  int maximum = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    bool differs = false;
    const auto count = [&](int x, int y) {
      const int distance = std::abs(x - y);
      differs |= distance != 0;
      maximum = std::max(maximum, distance);
      sum += static_cast<std::uint64_t>(distance);
      squares += static_cast<std::uint64_t>(distance) * static_cast<std::uint64_t>(distance);
    };
    if (alike) {
      for (std::size_t c = 0; c < components; ++c) count(a.pixels[i * components + c], b.pixels[i * components + c]);
    } else {
      const auto x = rgba(a, i), y = rgba(b, i);
      for (std::size_t c = 0; c < 4; ++c) count(x[c], y[c]);
    }
    difference.differing_pixels += differs ? 1 : 0;
  }
  const double samples = static_cast<double>(pixels * components);
  difference.maximum = maximum;
  difference.mean = samples > 0 ? static_cast<double>(sum) / samples : 0;
  difference.psnr = squares == 0 ? std::numeric_limits<double>::infinity()
                                 : 10 * std::log10(255.0 * 255.0 * samples / static_cast<double>(squares));
  return difference;
}

}  // namespace gs::render
