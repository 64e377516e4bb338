#pragma once

#include "base/parallel.h"
#include "qnv/base/description.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

inline constexpr std::size_t kPaletteColors = 256;

/// Returns an approximate visual difference of two colours: the squared distance of luma and chroma, with luma counted
/// twice. Luma and chroma are YCoCg of the encoded values, which are roughly perceptually uniform. Exact, in integers.
[[nodiscard]] constexpr std::int32_t color_distance(const Rgb8& a, const Rgb8& b) {
  const std::int32_t r = a.r - b.r, g = a.g - b.g, blue = a.b - b.b;
  const std::int32_t luma = r + 2 * g + blue, orange = 2 * (r - blue), green = 2 * g - r - blue;
  return luma * luma + orange * orange + green * green;
}

/// Returns a palette of at most kPaletteColors colours for `colors`. If `colors` has at most kPaletteColors distinct
/// colours, returns exactly these, most frequent first. Otherwise returns cluster means (variance cut, then a few
/// rounds of k-means), largest cluster first. The result depends neither on the order of `colors` nor on the number of
/// threads. Returns an empty palette if `colors` is empty. Throws only bad_alloc.
[[nodiscard]] std::vector<Rgb8> make_palette(std::span<const Rgb8> colors, unsigned threads = 0);

/// Returns for each colour the index of the nearest palette entry, or of the first one if several are equally near.
/// `palette` has 1 to kPaletteColors entries.
[[nodiscard]] std::vector<std::uint8_t> palette_indices(std::span<const Rgb8> colors, std::span<const Rgb8> palette,
                                                        unsigned threads = 0);

}  // namespace gs::qnv
