#pragma once

#include "app/view/values/volume_grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace gs::app {

/// Counts of the values of a volume.
class VolumeHistogram {
 public:
  static constexpr std::size_t kBars = 256;

  /// Counts the values over the range of the grid. Values outside of it count at its ends. Any thread.
  explicit VolumeHistogram(const VolumeGrid& grid);

  [[nodiscard]] std::pair<float, float> range() const { return range_; }
  /// Returns the logarithm of each count, divided by the largest one: bars from the minimum to the maximum value.
  [[nodiscard]] const std::array<float, kBars>& log_counts() const { return log_counts_; }
  /// Returns the value that this part of all values, 0..1, does not exceed.
  [[nodiscard]] float percentile(double part) const;
  /// Returns the value that divides the values best into two classes (Otsu 1979).
  [[nodiscard]] float threshold() const;

 private:
  [[nodiscard]] float value_of(std::size_t bin) const;

  std::vector<std::uint64_t> counts_;  // fine bins, a multiple of kBars
  std::array<float, kBars> log_counts_{};
  std::uint64_t total_ = 0;
  std::pair<float, float> range_;
};

/// Parts of the values between which a contrast range spans: it leaves out outliers.
inline constexpr double kLowPart = 0.02, kHighPart = 0.98;
/// Returns the values at kLowPart and kHighPart; the whole range if these are equal.
[[nodiscard]] std::pair<float, float> contrast_range(const VolumeHistogram& histogram);

}  // namespace gs::app
