#pragma once

#include <cstdint>

namespace gs::qnv {

/// Sum of numbers in fixed point with `kBits` bits after the point. Unlike a sum of floats, it does not depend on
/// the order of its terms. So threads and processes may sum parts. Wraps around on overflow.
template <int kBits>
class FixedSum {
 public:
  /// Adds a number. Ignores numbers that are not finite, or have a magnitude of at least 2^(62 - kBits).
  void add(float number) {
    constexpr float kScale = static_cast<float>(std::uint64_t{1} << kBits);
    constexpr float kMost = static_cast<float>(std::uint64_t{1} << 62);
    const float scaled = number * kScale;
    if (scaled > -kMost && scaled < kMost)
      sum_ += static_cast<std::uint64_t>(static_cast<std::int64_t>(scaled + (scaled < 0 ? -0.5f : 0.5f)));
  }
  void add(const FixedSum& other) { sum_ += other.sum_; }
  [[nodiscard]] double value() const {
    return static_cast<double>(static_cast<std::int64_t>(sum_)) / static_cast<double>(std::uint64_t{1} << kBits);
  }

 private:
  std::uint64_t sum_ = 0;
};

}  // namespace gs::qnv
