#pragma once

#include "base/parallel.h"
#include "qnv/base/description.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

inline constexpr std::size_t kPaletteColors = 256;

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
