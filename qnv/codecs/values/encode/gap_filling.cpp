#include "qnv/codecs/values/encode/gap_filling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace gs::qnv::values {

namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

std::size_t index_in(const Extent& n, std::size_t x, std::size_t y, std::size_t z) { return (z * n[1] + y) * n[0] + x; }

// Returns the means of the numbers in boxes of 2 per axis. `number(i)` is NaN if there is none.
template <class Number>
std::vector<float> halved(const Extent& fine, const Number& number) {
  const Extent n = low_extent(fine, 1);
  std::vector<float> sums(sample_count(n), 0), counts(sample_count(n), 0);
  for (std::size_t z = 0; z < fine[2]; ++z)
    for (std::size_t y = 0; y < fine[1]; ++y)
      for (std::size_t x = 0; x < fine[0]; ++x) {
        const float value = number(index_in(fine, x, y, z));
        if (value != value) continue;
        const std::size_t to = index_in(n, x / 2, y / 2, z / 2);
        sums[to] += value;
        counts[to] += 1;
      }
  for (std::size_t i = 0; i < sums.size(); ++i) sums[i] = counts[i] > 0 ? sums[i] / counts[i] : kNone;
  return sums;
}

// Replaces missing means by those of the larger boxes.
void take_from(const Extent& n, std::vector<float>& means, const Extent& larger, const float* from) {
  for (std::size_t z = 0; z < n[2]; ++z)
    for (std::size_t y = 0; y < n[1]; ++y)
      for (std::size_t x = 0; x < n[0]; ++x) {
        float& mean = means[index_in(n, x, y, z)];
        if (mean != mean) mean = from[index_in(larger, x / 2, y / 2, z / 2)];
      }
}

}  // namespace

GapFilling::BatchMeans GapFilling::means_of(const SampleBatch& batch) const {
  BatchMeans all;
  Extent n{extent_[0], extent_[1], batch.count};
  all[0] = {low_extent(n, 1), halved(n, [&](std::size_t i) {
              return batch.missing[i] != 0 ? kNone : static_cast<float>(batch.samples[i]);
            })};
  for (std::size_t i = 1; i < all.size(); ++i)
    all[i] = {low_extent(n, static_cast<int>(i) + 1),
              halved(all[i - 1].n, [&](std::size_t k) { return all[i - 1].means[k]; })};
  return all;
}

void GapFilling::measure(const SampleBatch& batch) {
  if (levels_.empty()) levels_.push_back({low_extent(extent_, 3), {}});
  const Means last = means_of(batch).back();
  levels_.front().means.insert(levels_.front().means.end(), last.means.begin(), last.means.end());
}

void GapFilling::finish(Ranks& ranks) {
  if (levels_.empty()) levels_.push_back({low_extent(extent_, 3), {}});
  levels_.front().means = gather_records(ranks, std::span<const float>(levels_.front().means));
  while (sample_count(levels_.back().n) > 1 &&
         std::ranges::any_of(levels_.back().means, [](float mean) { return mean != mean; })) {
    const Means& finer = levels_.back();
    levels_.push_back({low_extent(finer.n, 1), halved(finer.n, [&](std::size_t i) { return finer.means[i]; })});
  }
  for (std::size_t i = levels_.size() - 1; i-- > 0;)
    take_from(levels_[i].n, levels_[i].means, levels_[i + 1].n, levels_[i + 1].means.data());
}

void GapFilling::fill(SampleBatch& batch) const {
  if (std::ranges::find(batch.missing, 1) == batch.missing.end()) return;
  BatchMeans all = means_of(batch);
  const Means& whole = levels_.front();
  const std::size_t slice = std::size_t{whole.n[0]} * whole.n[1];
  const float* const from = whole.means.data() + batch.first / kBatchSlices * slice;
  std::copy_n(from, all[2].means.size(), all[2].means.begin());
  for (std::size_t i = all.size() - 1; i-- > 0;)
    take_from(all[i].n, all[i].means, all[i + 1].n, all[i + 1].means.data());
  const Extent n{extent_[0], extent_[1], batch.count};
  for (std::size_t z = 0; z < n[2]; ++z)
    for (std::size_t y = 0; y < n[1]; ++y)
      for (std::size_t x = 0; x < n[0]; ++x)
        if (const std::size_t at = index_in(n, x, y, z); batch.missing[at] != 0)
          batch.samples[at] = static_cast<std::int32_t>(all[0].means[index_in(all[0].n, x / 2, y / 2, z / 2)]);
}

}  // namespace gs::qnv::values
