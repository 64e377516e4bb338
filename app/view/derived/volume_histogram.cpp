#include "app/view/derived/volume_histogram.h"

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

constexpr std::size_t kFineBins = 16;  // fine bins per bar
constexpr std::size_t kBins = VolumeHistogram::kBars * kFineBins;

}  // namespace

VolumeHistogram::VolumeHistogram(const VolumeGrid& grid) : counts_(kBins), range_(grid.value_range()) {
  const auto [least, most] = range_;
  const float scale = most > least ? static_cast<float>(kBins - 1) / (most - least) : 0;
  for (std::uint32_t z = 0; z < grid.kept(2); ++z)
    for (const float value : grid.kept_slice(z))
      if (value == value) ++counts_[static_cast<std::size_t>(std::clamp((value - least) * scale, 0.0f, kBins - 1.0f))];
  float largest = 0;
  for (std::size_t i = 0; i < kBins; ++i) total_ += counts_[i];
  for (std::size_t bar = 0; bar < kBars; ++bar) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < kFineBins; ++i) count += counts_[bar * kFineBins + i];
    log_counts_[bar] = std::log1p(static_cast<float>(count));
    largest = std::max(largest, log_counts_[bar]);
  }
  if (largest > 0)
    for (float& bar : log_counts_) bar /= largest;
}

float VolumeHistogram::value_of(std::size_t bin) const {
  return range_.first + (range_.second - range_.first) * static_cast<float>(bin) / static_cast<float>(kBins - 1);
}

float VolumeHistogram::percentile(double part) const {
  const double wanted = std::clamp(part, 0.0, 1.0) * static_cast<double>(total_);
  std::uint64_t sum = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    sum += counts_[bin];
    if (sum > 0 && static_cast<double>(sum) >= wanted) return value_of(bin);
  }
  return range_.second;
}

float VolumeHistogram::threshold() const {
  double all = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) all += static_cast<double>(bin) * static_cast<double>(counts_[bin]);
  double below = 0, sum = 0, best = -1;
  std::size_t first = 0, last = 0;  // bins between which the threshold is equally good
  for (std::size_t bin = 0; bin + 1 < kBins; ++bin) {
    below += static_cast<double>(counts_[bin]);
    sum += static_cast<double>(bin) * static_cast<double>(counts_[bin]);
    const double above = static_cast<double>(total_) - below;
    if (!(below > 0 && above > 0)) continue;
    const double distance = sum / below - (all - sum) / above;
    const double variance = below * above * distance * distance;
    if (variance > best) {
      best = variance;
      first = bin;
    }
    if (variance >= best) last = bin;
  }
  return (value_of(first) + value_of(last + 1)) / 2;
}

std::pair<float, float> contrast_range(const VolumeHistogram& histogram) {
  const float low = histogram.percentile(kLowPart), high = histogram.percentile(kHighPart);
  return low < high ? std::pair(low, high) : histogram.range();
}

}  // namespace gs::app
