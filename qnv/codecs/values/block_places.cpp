#include "qnv/codecs/values/block_places.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>

namespace gs::qnv::values {

BlockLayout::BlockLayout(Extent extent, int levels) : extent_(extent), levels_(levels) {
  for (int level = std::max(levels, 1); level > 0; --level) {
    Level one;
    one.level = level;
    one.whole = low_extent(extent, level - 1);
    one.low = levels == 0 ? one.whole : low_extent(extent, level);
    one.first = count_;
    one.count = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      one.blocks[a] = one.low[a] / kBlockEdge + (one.low[a] % kBlockEdge != 0 ? 1 : 0);
      one.count *= one.blocks[a];
    }
    count_ += one.count;
    all_.push_back(one);
  }
}

std::uint64_t BlockLayout::count_of(int level) const {
  for (const Level& one : all_)
    if (one.level == level) return one.count;
  return 0;
}

std::uint64_t BlockLayout::number(int level, Extent at) const {
  for (const Level& one : all_)
    if (one.level == level) return one.first + (std::uint64_t{at[2]} * one.blocks[1] + at[1]) * one.blocks[0] + at[0];
  return count_;
}

std::uint64_t BlockLayout::first_of(int level) const {
  for (const Level& one : all_)
    if (one.level == level) return one.first;
  return count_;
}

Extent BlockLayout::blocks_of(int level) const {
  for (const Level& one : all_)
    if (one.level == level) return one.blocks;
  return {};
}

BlockPlace BlockLayout::place(std::uint64_t number) const {
  std::size_t i = 0;
  while (number - all_[i].first >= all_[i].count) ++i;
  const Level& level = all_[i];
  const bool untransformed = levels_ == 0, top = i == 0;
  number -= level.first;
  const std::uint64_t row = level.blocks[0], slice = row * level.blocks[1];
  const Extent at{static_cast<std::uint32_t>(number % row) * kBlockEdge,
                  static_cast<std::uint32_t>(number % slice / row) * kBlockEdge,
                  static_cast<std::uint32_t>(number / slice) * kBlockEdge};
  BlockPlace place;
  place.level = level.level;
  for (std::size_t a = 0; a < 3; ++a) {
    const int shift = untransformed ? 0 : level.level;
    place.first[a] = at[a] << shift;
    place.size[a] = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(std::uint64_t{kBlockEdge} << shift, extent_[a] - place.first[a]));
  }
  for (unsigned band = top ? 0 : 1; band < (untransformed ? 1u : 8u); ++band) {
    BandPart part;
    part.highs = std::popcount(band);
    bool empty = false;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool high = (band >> a & 1) != 0;
      const std::uint32_t n = high ? level.whole[a] - level.low[a] : level.low[a];
      empty = empty || at[a] >= n;
      part.first[a] = at[a] + (high ? level.low[a] : 0);
      part.size[a] = empty ? 0 : std::min(kBlockEdge, n - at[a]);
    }
    if (!empty) place.bands[place.band_count++] = part;
  }
  return place;
}

double error_weight(int level, int highs) {
  constexpr double kLow = 1.3216;  // square of the scale that makes the low band orthonormal
  constexpr int kMost = 3 * 32;    // of the absolute exponent
  static const auto kPowers = [] {
    std::array<double, 2 * kMost + 1> powers{};
    for (int i = -kMost; i <= kMost; ++i) powers[static_cast<std::size_t>(i + kMost)] = std::pow(kLow, i);
    return powers;
  }();
  const int exponent = 3 * (level - 1) + (3 - highs) - highs;
  return kPowers[static_cast<std::size_t>(std::clamp(exponent, -kMost, kMost) + kMost)];
}

}  // namespace gs::qnv::values
