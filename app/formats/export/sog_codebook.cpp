#include "app/formats/export/sog_codebook.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

namespace gs::app {
namespace {

constexpr int kLloydRounds = 40;

/// Group of points that becomes one entry of a palette: a range of `order`, and the plane that splits it.
struct PaletteGroup {
  std::size_t first = 0, end = 0, axis = 0;
  float at = 0;       // mean along `axis`
  double spread = 0;  // sum of the squared distances from the mean
};
bool operator<(const PaletteGroup& a, const PaletteGroup& b) { return a.spread < b.spread; }

/// Points to split, and their order, in which each group is a range.
struct PalettePoints {
  std::span<const float> points;
  std::size_t dimensions = 0;
  std::vector<std::uint32_t> order;

  [[nodiscard]] float at(std::size_t place, std::size_t axis) const { return points[order[place] * dimensions + axis]; }
};

PaletteGroup palette_group(const PalettePoints& all, std::size_t first, std::size_t end) {
  PaletteGroup group{first, end};
  const auto count = static_cast<double>(end - first);
  std::vector<double> sums(all.dimensions), squares(all.dimensions);
  for (std::size_t i = first; i < end; ++i)
    for (std::size_t k = 0; k < all.dimensions; ++k) {
      const auto value = static_cast<double>(all.at(i, k));
      sums[k] += value;
      squares[k] += value * value;
    }
  double most = -1;
  for (std::size_t k = 0; k < all.dimensions; ++k) {
    const double spread = std::max(0.0, squares[k] - sums[k] * sums[k] / count);
    group.spread += spread;
    if (spread > most) {
      most = spread;
      group.axis = k;
      group.at = static_cast<float>(sums[k] / count);
    }
  }
  return group;
}

}  // namespace

SogCodebook sog_codebook_of(std::vector<float> values) {
  SogCodebook codebook{};
  if (values.empty()) return codebook;
  std::ranges::sort(values);
  const std::size_t size = codebook.size(), count = values.size();
  std::vector<double> sums(count + 1);
  for (std::size_t i = 0; i < count; ++i) sums[i + 1] = sums[i] + static_cast<double>(values[i]);
  // Starts with quantiles of the values, and with equally spaced numbers, half of each.
  for (std::size_t i = 0; i < size; ++i) {
    const float part = static_cast<float>(i) / static_cast<float>(size - 1);
    codebook[i] =
        i % 2 == 0 ? values[i * (count - 1) / (size - 1)] : values.front() + part * (values.back() - values.front());
  }
  std::ranges::sort(codebook);
  for (int round = 0; round < kLloydRounds; ++round) {
    bool moved = false;
    std::size_t first = 0;
    for (std::size_t i = 0; i < size; ++i) {
      std::size_t end = count;
      if (i + 1 < size) {
        const float border = codebook[i] + (codebook[i + 1] - codebook[i]) / 2;
        end = static_cast<std::size_t>(std::ranges::upper_bound(values, border) - values.begin());
      }
      end = std::max(end, first);
      if (end > first) {
        const auto mean = static_cast<float>((sums[end] - sums[first]) / static_cast<double>(end - first));
        moved = moved || mean != codebook[i];
        codebook[i] = mean;
      }
      first = end;
    }
    std::ranges::sort(codebook);
    if (!moved) break;
  }
  return codebook;
}

std::uint8_t sog_code_of(const SogCodebook& codebook, float value) {
  const auto above = std::ranges::lower_bound(codebook, value);
  if (above == codebook.begin()) return 0;
  const auto below = above - 1;
  const bool up = above != codebook.end() && *above - value < value - *below;
  return static_cast<std::uint8_t>((up ? above : below) - codebook.begin());
}

SogPalette sog_palette_of(std::span<const float> points, std::size_t dimensions, std::size_t most) {
  PalettePoints all{points, dimensions, std::vector<std::uint32_t>(points.size() / dimensions)};
  std::iota(all.order.begin(), all.order.end(), 0);
  SogPalette palette;
  palette.labels.resize(all.order.size());
  if (all.order.empty()) return palette;
  std::priority_queue<PaletteGroup> groups;
  groups.push(palette_group(all, 0, all.order.size()));
  while (groups.size() < most && groups.top().spread > 0) {
    const PaletteGroup group = groups.top();
    const auto begin = all.order.begin();
    const auto middle =
        std::partition(begin + static_cast<std::ptrdiff_t>(group.first), begin + static_cast<std::ptrdiff_t>(group.end),
                       [&](std::uint32_t point) { return points[point * dimensions + group.axis] < group.at; });
    const auto at = static_cast<std::size_t>(middle - begin);
    if (at == group.first || at == group.end) break;  // points differ by rounding only
    groups.pop();
    groups.push(palette_group(all, group.first, at));
    groups.push(palette_group(all, at, group.end));
  }
  std::vector<double> sum(dimensions);
  for (std::uint16_t label = 0; !groups.empty(); ++label, groups.pop()) {
    const PaletteGroup& group = groups.top();
    std::ranges::fill(sum, 0.0);
    for (std::size_t i = group.first; i < group.end; ++i) {
      palette.labels[all.order[i]] = label;
      for (std::size_t k = 0; k < dimensions; ++k) sum[k] += static_cast<double>(all.at(i, k));
    }
    for (const double value : sum)
      palette.centers.push_back(static_cast<float>(value / static_cast<double>(group.end - group.first)));
  }
  return palette;
}

}  // namespace gs::app
