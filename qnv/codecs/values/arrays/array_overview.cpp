#include "qnv/codecs/values/arrays/array_overview.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace gs::qnv::values {

namespace {

constexpr float kNoSample = std::numeric_limits<float>::quiet_NaN();
constexpr std::uint32_t kLeastBlock = 4;  // edge in samples, of blocks of several chunks
constexpr std::size_t kMostKept = std::size_t{1} << 25;  // samples of the level that is read

/// Returns the level to read: the finest one for which no more chunks are decoded, within the memory.
int overview_level(const ArrayLevels& levels) {
  const int base = levels.base();
  const Extent chunk = levels.chunk(base);
  // Chunks that have several samples per axis are decoded for any level.
  const bool all = chunk != Extent{} && levels.decodes_all(base) && levels.decodes_all(base - 1);
  return all && sample_count(levels.layouts()[static_cast<std::size_t>(base - 1)].dimensions) <= kMostKept ? base - 1
                                                                                                           : base;
}

/// Returns the edges of blocks. They have whole chunks, and whole slices of arrays without chunks.
Extent block_edges(const ArrayLevels& levels, int level, const Extent& extent) {
  Extent edge = levels.chunk(level);
  if (edge == Extent{}) return {extent[0], extent[1], 1};
  // Servers get requests for several chunks of a coarse version at once.
  const std::uint32_t chunks = levels.has_version(level) ? 2 : 1;
  for (std::size_t a = 0; a < 3; ++a) {
    edge[a] = std::min(edge[a], extent[a]) * chunks;
    while (edge[a] < kLeastBlock) edge[a] *= 2;
    edge[a] = std::min(edge[a], extent[a]);
  }
  return edge;
}

}  // namespace

ArrayOverview::ArrayOverview(const ArrayLevels& levels)
    : levels_(levels),
      level_(overview_level(levels)),
      extent_(levels.layouts()[static_cast<std::size_t>(level_)].dimensions),
      edge_(block_edges(levels, level_, extent_)),
      coarse_(levels.layouts().back().dimensions) {
  for (std::size_t a = 0; a < 3; ++a) {
    count_[a] = (extent_[a] - 1) / edge_[a] + 1;
    step_[a] = level_ < levels.base() && extent_[a] > 1 ? 2 : 1;
  }
  order_.resize(sample_count(count_));
  std::iota(order_.begin(), order_.end(), 0u);
  means_.assign(order_.size(), kNoSample);
  read_.assign(order_.size(), 0);
  samples_.assign(sample_count(extent_), kNoSample);
  // Blocks at multiples of large powers of two come first.
  const auto coarseness = [this](std::uint32_t block) {
    const std::uint32_t bits = block % count_[0] | block / count_[0] % count_[1] | block / count_[0] / count_[1];
    return std::countr_zero(bits);
  };
  std::ranges::stable_sort(order_, [&](std::uint32_t a, std::uint32_t b) { return coarseness(a) > coarseness(b); });
}

bool ArrayOverview::restore(std::vector<float> samples) {
  if (samples.size() != samples_.size()) return false;
  samples_ = std::move(samples);
  next_ = order_.size();
  return true;
}

SampleBox ArrayOverview::box_of(std::uint32_t block) const {
  const Extent at{block % count_[0], block / count_[0] % count_[1], block / count_[0] / count_[1]};
  SampleBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.first[a] = at[a] * edge_[a];
    box.size[a] = std::min(edge_[a], extent_[a] - box.first[a]);
  }
  return box;
}

bool ArrayOverview::read(const std::function<bool()>& stop) {
  std::vector<float> values;
  for (; next_ < order_.size() && !stop(); ++next_) {
    const std::uint32_t block = order_[next_];
    const SampleBox box = box_of(block);
    if (!levels_.read(level_, box, values)) {
      if (stop()) return good_;
      good_ = false;
      continue;
    }
    double sum = 0;
    std::size_t known = 0;
    const float* from = values.data();
    for (std::uint32_t z = 0; z < box.size[2]; ++z)
      for (std::uint32_t y = 0; y < box.size[1]; ++y, from += box.size[0])
        std::copy_n(from, box.size[0],
                    samples_.data() + ((box.first[2] + z) * std::size_t{extent_[1]} + box.first[1] + y) * extent_[0] +
                        box.first[0]);
    for (const float value : values)
      if (value == value) sum += static_cast<double>(value), ++known;
    if (known > 0) means_[block] = static_cast<float>(sum / static_cast<double>(known));
    read_[block] = 1;
  }
  return good_;
}

double ArrayOverview::progress() const {
  return order_.empty() ? 1 : static_cast<double>(next_) / static_cast<double>(order_.size());
}

// Returns the distance of the blocks of the finest grid of blocks that was read completely.
std::uint32_t ArrayOverview::spacing() const {
  std::uint32_t spacing = 1;
  for (std::size_t i = next_; i < order_.size(); ++i) {
    const std::uint32_t block = order_[i];
    const std::uint32_t bits = block % count_[0] | block / count_[0] % count_[1] | block / count_[0] / count_[1];
    // The first one that is not read is on the coarsest incomplete grid.
    return bits == 0 ? std::bit_ceil(std::max({count_[0], count_[1], count_[2]})) : 2u << std::countr_zero(bits);
  }
  return spacing;
}

template <class Visit>
void ArrayOverview::visit_coarse(const SampleBox& box, const Visit& visit) const {
  Extent first{}, end{};
  for (std::size_t a = 0; a < 3; ++a) {
    first[a] = (box.first[a] + step_[a] - 1) / step_[a];
    end[a] = (box.first[a] + box.size[a] - 1) / step_[a] + 1;
  }
  for (std::uint32_t z = first[2]; z < end[2]; ++z)
    for (std::uint32_t y = first[1]; y < end[1]; ++y)
      for (std::uint32_t x = first[0]; x < end[0]; ++x)
        visit((std::size_t{z} * coarse_[1] + y) * coarse_[0] + x, Extent{x * step_[0], y * step_[1], z * step_[2]});
}

void ArrayOverview::fill(std::vector<float>& samples, const SampleBox& box, std::uint32_t spacing) const {
  visit_coarse(box, [&](std::size_t to, const Extent& at) {
    std::array<std::array<std::uint32_t, 2>, 3> ends{};
    std::array<double, 3> part{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double place = std::max((at[a] + 0.5) / edge_[a] - 0.5, 0.0) / spacing;
      const std::uint32_t last = (count_[a] - 1) / spacing;
      const auto low = std::min(static_cast<std::uint32_t>(place), last);
      ends[a] = {low * spacing, std::min(low + 1, last) * spacing};
      part[a] = std::min(place - low, 1.0);
    }
    double sum = 0, weights = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
      double weight = 1;
      Extent block{};
      for (std::size_t a = 0; a < 3; ++a) {
        const unsigned high = corner >> a & 1;
        block[a] = ends[a][high];
        weight *= high != 0 ? part[a] : 1 - part[a];
      }
      const float mean = means_[(std::size_t{block[2]} * count_[1] + block[1]) * count_[0] + block[0]];
      if (mean == mean) sum += weight * static_cast<double>(mean), weights += weight;
    }
    if (weights >= 0.5) samples[to] = static_cast<float>(sum / weights);
  });
}

// Mixes the slices that were not read from those before and after.
void ArrayOverview::fill_slices(std::vector<float>& samples) const {
  const std::size_t slice = std::size_t{extent_[0]} * extent_[1];
  std::vector<std::uint32_t> known;
  for (std::uint32_t z = 0; z < extent_[2]; ++z)
    if (read_[z] != 0) known.push_back(z);
  for (std::uint32_t z = 0; z < extent_[2] && !known.empty(); ++z) {
    if (read_[z] != 0) continue;
    const auto next = std::ranges::upper_bound(known, z);
    const std::uint32_t above = next == known.end() ? known.back() : *next,
                        below = next == known.begin() ? above : *std::prev(next);
    const float part = above > below ? static_cast<float>(z - below) / static_cast<float>(above - below) : 0.0f;
    for (std::size_t i = 0; i < slice; ++i) {
      const float low = samples_[below * slice + i], high = samples_[above * slice + i];
      samples[z * slice + i] = low != low ? high : high != high ? low : low + (high - low) * part;
    }
  }
}

std::vector<float> ArrayOverview::samples() const {
  if (level_ == levels_.base() && complete()) return samples_;
  std::vector<float> all(sample_count(coarse_));
  visit_coarse({{0, 0, 0}, extent_}, [&](std::size_t to, const Extent& at) {
    all[to] = samples_[(std::size_t{at[2]} * extent_[1] + at[1]) * extent_[0] + at[0]];
  });
  if (complete() || next_ == 0) return all;
  if (step_ == Extent{1, 1, 1} && edge_ == Extent{extent_[0], extent_[1], 1}) {
    fill_slices(all);
    return all;
  }
  const std::uint32_t distance = spacing();
  for (std::size_t i = next_; i < order_.size(); ++i) fill(all, box_of(order_[i]), distance);
  return all;
}

}  // namespace gs::qnv::values
