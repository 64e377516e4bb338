#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

namespace gs::qnv::values {

/// Minimum and maximum sample of a volume. Truncated streams have samples beyond them, because bands are missing.
struct SampleLimits {
  std::int32_t least = std::numeric_limits<std::int32_t>::min();
  std::int32_t most = std::numeric_limits<std::int32_t>::max();

  void apply(std::span<std::int32_t> samples) const {
    if (least == std::numeric_limits<std::int32_t>::min() && most == std::numeric_limits<std::int32_t>::max()) return;
    for (std::int32_t& sample : samples) sample = std::min(std::max(sample, least), most);
  }
  friend bool operator==(const SampleLimits&, const SampleLimits&) = default;
};

/// Returns the samples at the ends of a range of values, if `value = zero + unit * sample`. Rounds the ends outwards by
/// the precision of float. Returns no limits if an end is not finite or the range is reversed.
[[nodiscard]] inline SampleLimits sample_limits(std::pair<float, float> range, double unit, double zero) {
  const auto [low, high] = range;
  if (!std::isfinite(low) || !std::isfinite(high) || low > high || !std::isfinite(zero) || !std::isfinite(unit) ||
      unit == 0)
    return {};
  const double spare = std::ldexp(std::max(std::abs(double{low}), std::abs(double{high})), -23);
  double least = (low - spare - zero) / unit, most = (high + spare - zero) / unit;
  if (unit < 0) std::swap(least, most);
  const auto sample = [](double at) {
    return static_cast<std::int32_t>(std::clamp(at, double{std::numeric_limits<std::int32_t>::min()},
                                                double{std::numeric_limits<std::int32_t>::max()}));
  };
  return {sample(std::floor(least + 0.5)), sample(std::ceil(most - 0.5))};
}

}  // namespace gs::qnv::values
