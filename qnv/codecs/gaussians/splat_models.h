#pragma once

#include "qnv/entropy/binary_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

namespace gs::qnv::gaussians {

using displaced::BinaryDecoder;
using displaced::BinaryEncoder;
using displaced::BitModel;

/// Models of a number >= 0: unary steps, then an Exp-Golomb code. It is smaller than displaced::NumberModel, because
/// every cluster keeps its models.
template <std::size_t Steps>
struct ShortNumberModel {
  static constexpr int kMostBits = 26;
  std::array<BitModel, Steps> more;
  std::array<BitModel, 8> prefix;

  template <class Coder>
  std::uint32_t code(Coder& coder, std::uint32_t value) {
    const std::uint32_t steps = coder.unary(more, value);
    return steps < Steps ? steps : steps + code_rest(coder, value - steps + 1);
  }

 private:
  template <class Coder>
  std::uint32_t code_rest(Coder& coder, std::uint32_t rest) {
    const int wanted = std::bit_width(rest) - 1;
    int bits = 0;
    while (bits < kMostBits && coder.bit(prefix[static_cast<std::size_t>(std::min(bits, 7))], bits < wanted)) ++bits;
    const std::uint32_t low = coder.bits(rest & ((1u << bits) - 1), bits);
    return (1u << bits | low) - 1;
  }
};

/// Encoder with the calls of Reader, so that both directions share their code.
struct Writer {
  static constexpr bool kWrites = true;
  BinaryEncoder* coder;

  bool bit(BitModel& model, bool value) {
    coder->put(model, value);
    return value;
  }
  std::uint32_t unary(std::span<BitModel> models, std::uint32_t value) {
    const auto most = static_cast<std::uint32_t>(models.size());
    for (std::uint32_t i = 0; i < std::min(value, most); ++i) coder->put(models[i], true);
    if (value < most) coder->put(models[value], false);
    return std::min(value, most);
  }
  std::uint32_t bits(std::uint32_t value, int count) {
    coder->put_bits(value, count);
    return value;
  }
};

/// Decoder. Values that are passed are ignored.
struct Reader {
  static constexpr bool kWrites = false;
  BinaryDecoder coder;

  bool bit(BitModel& model, bool) { return coder.get(model); }
  std::uint32_t unary(std::span<BitModel> models, std::uint32_t) {
    return static_cast<std::uint32_t>(coder.get_unary(models));
  }
  std::uint32_t bits(std::uint32_t, int count) { return coder.get_bits(count); }
};

/// Models of signed numbers with a known typical size.
template <std::size_t Sizes>
struct SignedModel {
  std::array<ShortNumberModel<10>, Sizes> magnitudes;
  std::array<BitModel, Sizes> signs;

  /// Codes a number. `size` is log2 of its typical magnitude in halves, plus 2.
  template <class Coder>
  std::int32_t code(Coder& coder, int size, std::int32_t value) {
    const auto at = static_cast<std::size_t>(std::clamp(size, 0, static_cast<int>(Sizes) - 1));
    // The low bits of large numbers have no models: a quarter of the typical magnitude.
    const int low = std::clamp((size - 2) / 2 - 2, 0, 24);
    const auto magnitude = static_cast<std::uint32_t>(std::abs(value));
    std::uint32_t coded = magnitudes[at].code(coder, magnitude >> low) << low;
    if (low > 0) coded |= coder.bits(magnitude & ((1u << low) - 1), low);
    if (coded == 0) return 0;
    const bool negative = coder.bit(signs[at], value < 0);
    const auto result = static_cast<std::int32_t>(coded & 0x3fffffff);
    return negative ? -result : result;
  }
};

/// Running mean of magnitudes, in 1/16.
struct TypicalSize {
  std::uint16_t mean = 64;

  /// Returns the size for SignedModel.
  [[nodiscard]] int size() const {
    const std::uint32_t square = std::uint32_t{mean} * mean;
    return static_cast<int>(std::bit_width(square)) - 1 - 8 + 2;
  }
  void learn(std::int32_t value) {
    const std::int32_t magnitude = std::min(std::abs(value), 2047) * 16;
    mean = static_cast<std::uint16_t>(std::max(1, mean + (magnitude - mean) / 8));
  }
};

/// Models of the Gaussians of a cluster. A cluster starts with those at the end of its parent.
struct SplatModels {
  ShortNumberModel<16> children;
  std::array<BitModel, 3> leaf;                        // by the previous sibling: none, inner, leaf
  std::array<std::array<SignedModel<10>, 2>, 2> size;  // largest scale, by leaf and by the presence of a sibling
  std::array<std::array<std::array<ShortNumberModel<20>, 6>, 2>, 2> gaps;  // by axis, leaf, and the sibling's gap
  std::array<std::array<SignedModel<8>, 2>, 2> opacity;                    // by leaf and by the presence of a sibling
  std::array<std::array<SignedModel<10>, 3>, 2> turn, color;               // by leaf and component
  std::array<SignedModel<20>, 2> place;                                    // by leaf
  std::array<std::array<TypicalSize, 3>, 2> color_size;
  std::array<std::array<TypicalSize, 2>, 2> scale_size, opacity_size;
};

/// Returns floor(2 log2(value)) + 2 for a number >= 0. Returns 0 for numbers below 2^-1022, infinity and NaN.
[[nodiscard]] inline int size_of(double value) {
  // The fraction of a double has 52 bits, and its exponent an offset of 1023.
  constexpr std::uint64_t kFraction = (std::uint64_t{1} << 52) - 1, kRoot = 0x6a09e667f3bcd;  // of the root of 2
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const auto exponent = static_cast<int>(bits >> 52);
  if (exponent == 0 || exponent >= 0x7ff) return 0;
  return 2 * (exponent - 1023) + ((bits & kFraction) >= kRoot ? 1 : 0) + 2;
}

}  // namespace gs::qnv::gaussians
