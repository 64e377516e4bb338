#pragma once

#include "qnv/entropy/binary_coder.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <type_traits>

namespace gs::qnv::exact {

// Integer arithmetic for tails (FORMAT.md, "Exact tail"). All decoding decisions use integers, so that every machine
// decodes the same mesh.

/// Adaptive probability of a yes. Keeps two estimates: one learns fast, the other slowly.
struct TwoRates {
  std::uint16_t fast = 32768, slow = 32768;  // in units of 1/65536
  std::uint8_t seen = 0;                     // number of decisions, at most kMaxSeen

  static constexpr std::uint8_t kMaxSeen = 254, kFastSeen = 30;
  static constexpr auto kRates = displaced::learning_rates<kMaxSeen + 1>();
  void learn(bool bit) {
    const std::int64_t target = bit ? 65535 : 0;
    fast = static_cast<std::uint16_t>(fast + ((target - fast) * kRates[std::min(seen, kFastSeen)] >> 16));
    slow = static_cast<std::uint16_t>(slow + ((target - slow) * kRates[seen] >> 16));
    seen = static_cast<std::uint8_t>(seen + (seen < kMaxSeen ? 1 : 0));
  }
  [[nodiscard]] std::uint32_t sum() const { return std::uint32_t{fast} + slow; }
};

/// Models of the bit lengths of numbers.
struct Lengths {
  static constexpr std::size_t kMax = 23;
  std::array<TwoRates, kMax> longer;
};
/// Models of the two bits after the leading bit of a number, by the number's bit length.
struct Digits {
  std::array<std::array<TwoRates, 3>, Lengths::kMax + 1> of;
};

/// Coder of decisions. With BinaryEncoder as `Coder`, writes and returns the given values. With BinaryDecoder, ignores
/// the given values and returns the decoded ones.
template <class Coder>
class Decisions {
 public:
  static constexpr bool kWrites = std::is_same_v<Coder, displaced::BinaryEncoder>;

  explicit Decisions(Coder& coder) : coder_(coder) {}

  bool bit(TwoRates& model, bool value) {
    const bool is = decide(model.sum() >> 1, value);
    model.learn(is);
    return is;
  }
  /// Codes a decision with the mean probability of two models, each for a different context.
  bool bit(TwoRates& one, TwoRates& other, bool value) {
    const bool is = decide((one.sum() + other.sum()) >> 2, value);
    one.learn(is);
    other.learn(is);
    return is;
  }
  std::uint32_t bits(std::uint32_t value, int count) {
    if constexpr (kWrites) {
      coder_.put_bits(value, count);
      return value;
    } else {
      return coder_.get_bits(count);
    }
  }
  /// Codes a signed integer; its magnitude is below 2^Lengths::kMax.
  int number(Lengths& one, Lengths& other, Digits& digits, int value) {
    const auto size = static_cast<std::uint32_t>(std::abs(value));
    const auto length = static_cast<std::size_t>(std::bit_width(size));
    std::size_t l = 0;
    while (l < Lengths::kMax && bit(one.longer[l], other.longer[l], l < length)) ++l;
    if (l == 0) return 0;
    const bool negative = bits(value < 0 ? 1 : 0, 1) != 0;
    std::uint32_t read = 1;
    int left = static_cast<int>(l) - 1;
    std::size_t which = 0;
    for (int k = 0; k < 2 && left > 0; ++k) {
      --left;
      const bool is = bit(digits.of[l][which], (size >> left & 1) != 0);
      read = read << 1 | (is ? 1u : 0u);
      which = is ? 2 : 1;
    }
    if (left > 0) read = read << left | bits(size & ((1u << left) - 1), left);
    return negative ? -static_cast<int>(read) : static_cast<int>(read);
  }
  [[nodiscard]] bool good() const {
    if constexpr (kWrites)
      return true;
    else
      return !coder_.exhausted();
  }

 private:
  bool decide(std::uint32_t probability, bool value) {
    const std::uint32_t p = std::clamp<std::uint32_t>(probability, 64, 65536 - 64);
    if constexpr (kWrites) {
      coder_.put(p, value);
      return value;
    } else {
      return coder_.get(p);
    }
  }
  Coder& coder_;
};

/// Returns the magnitude class of x. Below 8, the class is x. Above, each octave has four classes: 8 and 9 form class
/// 8, 10 and 11 form class 9, ...
[[nodiscard]] constexpr std::uint32_t grade(std::uint64_t x) {
  if (x < 4) return static_cast<std::uint32_t>(x);
  const auto bits = static_cast<std::uint32_t>(std::bit_width(x));
  return (bits - 2) * 4 + static_cast<std::uint32_t>(x >> (bits - 3) & 3);
}

/// Integer vector with enough bits for products of coordinates.
using Long3 = std::array<std::int64_t, 3>;

[[nodiscard]] constexpr std::int64_t dot(const glm::ivec3& a, const glm::ivec3& b) {
  return std::int64_t{a.x} * b.x + std::int64_t{a.y} * b.y + std::int64_t{a.z} * b.z;
}
[[nodiscard]] constexpr std::int64_t dot(const Long3& a, const Long3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
[[nodiscard]] constexpr Long3 cross(const glm::ivec3& a, const glm::ivec3& b) {
  return {std::int64_t{a.y} * b.z - std::int64_t{a.z} * b.y, std::int64_t{a.z} * b.x - std::int64_t{a.x} * b.z,
          std::int64_t{a.x} * b.y - std::int64_t{a.y} * b.x};
}
/// Halves a vector, rounding down, until the magnitude of each component is at most 2^bits - 1.
[[nodiscard]] constexpr Long3 reduced(const Long3& v, int bits) {
  std::uint64_t most = 0;
  for (const std::int64_t c : v) most = std::max(most, static_cast<std::uint64_t>(c < 0 ? -c : c));
  const int shift = std::max(0, static_cast<int>(std::bit_width(most)) - bits);
  return {v[0] >> shift, v[1] >> shift, v[2] >> shift};
}
[[nodiscard]] constexpr std::int64_t floor_divide(std::int64_t a, std::int64_t b) {
  return a / b - (a % b != 0 && (a < 0) != (b < 0) ? 1 : 0);
}

}  // namespace gs::qnv::exact
