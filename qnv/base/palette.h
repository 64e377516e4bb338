#pragma once

#include "qnv/base/cloud.h"
#include "qnv/base/parallel.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

inline constexpr std::size_t kPaletteColors = 256;

/// How different two colours look, about: the squared distance of their luma and chroma (YCoCg of the encoded
/// values, which are roughly even to the eye), luma counting double. Exact, in integers.
[[nodiscard]] constexpr std::int32_t color_distance(const Rgb8& a, const Rgb8& b) {
  const std::int32_t r = a.r - b.r, g = a.g - b.g, blue = a.b - b.b;
  const std::int32_t luma = r + 2 * g + blue, orange = 2 * (r - blue), green = 2 * g - r - blue;
  return luma * luma + orange * orange + green * green;
}

/// Up to kPaletteColors colours that stand for `colors`: those themselves, the most frequent first, when there are no
/// more; otherwise the means of clusters (variance cut, then a few rounds of k-means), by their size. The same for
/// the same colours in any order, whatever the number of threads. Empty for none. Throws only bad_alloc.
[[nodiscard]] std::vector<Rgb8> make_palette(std::span<const Rgb8> colors, unsigned threads = 0);

/// For each colour the index of the nearest of `palette`, which has 1 to kPaletteColors; the first of several.
[[nodiscard]] std::vector<std::uint8_t> palette_indices(std::span<const Rgb8> colors, std::span<const Rgb8> palette,
                                                        unsigned threads = 0);

}  // namespace gs::qnv
