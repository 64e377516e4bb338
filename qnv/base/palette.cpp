#include "qnv/base/palette.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace gs::qnv {
namespace {

constexpr unsigned kBinBits = 6;  // bits per colour component
constexpr std::size_t kBins = std::size_t{1} << (3 * kBinBits);
constexpr int kRounds = 5;  // rounds of k-means; more rounds change little
constexpr std::size_t kColorsPerTask = 1 << 14;

// Group of colours that differ only in their lowest bits.
struct Bin {
  std::uint64_t count = 0;
  std::array<std::uint64_t, 3> sum{};  // sums of r, g, b
  void add(const Bin& other) {
    count += other.count;
    for (std::size_t i = 0; i < 3; ++i) sum[i] += other.sum[i];
  }
  [[nodiscard]] Rgb8 mean() const {
    const auto rounded = [&](std::size_t i) { return static_cast<std::uint8_t>((sum[i] + count / 2) / count); };
    return {rounded(0), rounded(1), rounded(2)};
  }
};

std::uint32_t packed(const Rgb8& c) { return std::uint32_t{c.r} << 16 | std::uint32_t{c.g} << 8 | c.b; }

// Returns the distinct colours with their counts. If there are more than kPaletteColors, returns kPaletteColors + 1
// entries.
std::vector<Bin> distinct(std::span<const Rgb8> colors) {
  std::vector<Bin> found;
  std::vector<std::uint16_t> at(4096, 0);  // open addressing; 1 + index
  for (const Rgb8& c : colors) {
    std::size_t slot = packed(c) * 2654435761u >> 20;
    while (at[slot] != 0 && found[at[slot] - 1u].mean() != c) slot = (slot + 1) % at.size();
    if (at[slot] == 0) {
      if (found.size() == kPaletteColors) {
        found.emplace_back();
        return found;
      }
      found.push_back({1, {c.r, c.g, c.b}});
      at[slot] = static_cast<std::uint16_t>(found.size());
      continue;
    }
    found[at[slot] - 1u].add({1, {c.r, c.g, c.b}});
  }
  return found;
}

std::vector<Bin> bins_of(std::span<const Rgb8> colors) {
  std::vector<Bin> all(kBins);
  constexpr unsigned drop = 8 - kBinBits;
  for (const Rgb8& c : colors)
    all[std::size_t{c.r} >> drop << (2 * kBinBits) | std::size_t{c.g} >> drop << kBinBits | c.b >> drop].add(
        {1, {c.r, c.g, c.b}});
  std::erase_if(all, [](const Bin& bin) { return bin.count == 0; });
  return all;
}

// Returns luma, counted twice, and chroma (YCoCg) of the encoded values, which are roughly perceptually uniform. The
// approximate visual difference of two colours is the sum of the squared differences.
std::array<std::int32_t, 3> coordinates(const Rgb8& c) {
  return {c.r + 2 * c.g + c.b, 2 * (c.r - c.b), 2 * c.g - c.r - c.b};
}

// Range of bins that will share a palette colour.
struct ColorCluster {
  std::size_t first, last;
  unsigned axis = 0;  // axis with the largest variance
  std::int32_t middle = 0;  // mean on that axis
  double error = 0;         // sum of squared differences from the mean, over all axes
};

ColorCluster measure(const std::vector<Bin>& bins, std::size_t first, std::size_t last) {
  // Integer sums do not depend on the order; 2^32 colours of 2^20 fit.
  std::array<std::int64_t, 3> sum{}, squares{};
  std::int64_t count = 0;
  for (std::size_t i = first; i < last; ++i) {
    const auto at = coordinates(bins[i].mean());
    const auto weight = static_cast<std::int64_t>(bins[i].count);
    count += weight;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sum[axis] += weight * at[axis];
      squares[axis] += weight * at[axis] * at[axis];
    }
  }
  ColorCluster cluster{first, last};
  double most = -1;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double mean = static_cast<double>(sum[axis]) / static_cast<double>(count);
    const double error = static_cast<double>(squares[axis]) - mean * static_cast<double>(sum[axis]);
    cluster.error += std::max(0.0, error);
    if (error <= most) continue;
    most = error;
    cluster.axis = axis;
    // Rounds down. Some bin is then above the mean, unless all bins are equal.
    cluster.middle = static_cast<std::int32_t>(sum[axis] / count - (sum[axis] % count < 0 ? 1 : 0));
  }
  if (last - first < 2) cluster.error = 0;
  return cluster;
}

// Splits the cluster with the largest error at its mean, until there are enough clusters.
std::vector<Rgb8> cut_by_variance(std::vector<Bin> bins) {
  std::vector<ColorCluster> clusters{measure(bins, 0, bins.size())};
  while (clusters.size() < kPaletteColors) {
    const auto worst = std::max_element(clusters.begin(), clusters.end(),
                                        [](const ColorCluster& a, const ColorCluster& b) { return a.error < b.error; });
    if (!(worst->error > 0)) break;
    const auto begin = bins.begin() + static_cast<std::ptrdiff_t>(worst->first);
    const auto end = bins.begin() + static_cast<std::ptrdiff_t>(worst->last);
    const auto middle = std::stable_partition(
        begin, end, [&](const Bin& bin) { return coordinates(bin.mean())[worst->axis] <= worst->middle; });
    const std::size_t first = worst->first, last = worst->last;
    const auto cut = static_cast<std::size_t>(middle - bins.begin());
    if (cut == first || cut == last) {  // all bins are equal
      worst->error = 0;
      continue;
    }
    *worst = measure(bins, first, cut);
    clusters.push_back(measure(bins, cut, last));
  }
  std::vector<Rgb8> result;
  for (const ColorCluster& cluster : clusters) {
    Bin all;
    for (std::size_t i = cluster.first; i < cluster.last; ++i) all.add(bins[i]);
    result.push_back(all.mean());
  }
  return result;
}

// Searches for the nearest palette entry. The palette is sorted by luma, which limits the search. The result equals
// that of an exhaustive search.
class Nearest {
 public:
  explicit Nearest(std::span<const Rgb8> palette) {
    for (std::size_t i = 0; i < palette.size(); ++i)
      entries_.push_back({coordinates(palette[i]), static_cast<std::uint8_t>(i)});
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return a.at[0] != b.at[0] ? a.at[0] < b.at[0] : a.index < b.index;
    });
  }
  [[nodiscard]] std::uint8_t operator()(const Rgb8& color) const {
    const auto at = coordinates(color);
    const auto from = std::lower_bound(entries_.begin(), entries_.end(), at[0],
                                       [](const Entry& e, std::int32_t luma) { return e.at[0] < luma; });
    Best best;
    for (auto entry = from; entry != entries_.end() && best.may_be(entry->at[0] - at[0]); ++entry)
      best.try_it(*entry, at);
    for (auto entry = from; entry != entries_.begin() && best.may_be(at[0] - (entry - 1)->at[0]);)
      best.try_it(*--entry, at);
    return best.index;
  }

 private:
  struct Entry {
    std::array<std::int32_t, 3> at;
    std::uint8_t index;
  };
  struct Best {
    std::int32_t distance = std::numeric_limits<std::int32_t>::max();
    std::uint8_t index = 255;
    [[nodiscard]] bool may_be(std::int32_t luma) const { return luma * luma <= distance; }
    void try_it(const Entry& e, const std::array<std::int32_t, 3>& at) {
      const std::int32_t x = e.at[0] - at[0], y = e.at[1] - at[1], z = e.at[2] - at[2];
      const std::int32_t d = x * x + y * y + z * z;
      if (d > distance || (d == distance && e.index > index)) return;
      distance = d, index = e.index;
    }
  };
  std::vector<Entry> entries_;
};

// Runs k-means: assigns bins to the nearest colour, and recomputes the colours.
std::vector<Bin> cluster(const std::vector<Bin>& bins, std::vector<Rgb8> palette, unsigned threads) {
  std::vector<std::uint8_t> nearest(bins.size());
  std::vector<Bin> sums;
  for (int round = 0; round < kRounds; ++round) {
    const Nearest find(palette);
    parallel_for((bins.size() + kColorsPerTask - 1) / kColorsPerTask,
                 [&](std::size_t block) {
                   for (std::size_t i = block * kColorsPerTask; i < std::min(bins.size(), (block + 1) * kColorsPerTask);
                        ++i)
                     nearest[i] = find(bins[i].mean());
                 },
                 threads);
    sums.assign(palette.size(), {});
    for (std::size_t i = 0; i < bins.size(); ++i) sums[nearest[i]].add(bins[i]);
    std::erase_if(sums, [](const Bin& bin) { return bin.count == 0; });
    palette.clear();
    for (const Bin& bin : sums) palette.push_back(bin.mean());
  }
  return sums;
}

}  // namespace

std::vector<Rgb8> make_palette(std::span<const Rgb8> colors, unsigned threads) {
  std::vector<Bin> found = distinct(colors);
  if (found.size() > kPaletteColors) {
    const std::vector<Bin> bins = bins_of(colors);
    found = cluster(bins, cut_by_variance(bins), threads);
  }
  std::sort(found.begin(), found.end(), [](const Bin& a, const Bin& b) {
    return a.count != b.count ? a.count > b.count : packed(a.mean()) < packed(b.mean());
  });
  std::vector<Rgb8> palette;
  for (const Bin& bin : found) palette.push_back(bin.mean());
  return palette;
}

std::vector<std::uint8_t> palette_indices(std::span<const Rgb8> colors, std::span<const Rgb8> palette,
                                          unsigned threads) {
  std::vector<std::uint8_t> result(colors.size());
  const Nearest find(palette);
  parallel_for((colors.size() + kColorsPerTask - 1) / kColorsPerTask,
               [&](std::size_t block) {
                 // Cache of recent colours, because colours often repeat.
                 struct Known {
                   std::uint32_t color = 0xffffffff;
                   std::uint8_t index = 0;
                 };
                 std::array<Known, 1024> known;
                 for (std::size_t i = block * kColorsPerTask; i < std::min(colors.size(), (block + 1) * kColorsPerTask);
                      ++i) {
                   const std::uint32_t color = packed(colors[i]);
                   Known& k = known[color * 2654435761u >> 22];
                   if (k.color != color) k = {color, find(colors[i])};
                   result[i] = k.index;
                 }
               },
               threads);
  return result;
}

}  // namespace gs::qnv
