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
    return code_at(coder, static_cast<std::size_t>(std::clamp(size, 0, static_cast<int>(Sizes) - 1)), size, value);
  }
  /// Codes a number as code() does, but all large numbers share the models of the last octave. Without their low bits,
  /// they have the same distribution.
  template <class Coder>
  std::int32_t code_shared(Coder& coder, int size, std::int32_t value) {
    constexpr int kSizes = static_cast<int>(Sizes);
    const int at = size < kSizes ? std::max(size, 0) : kSizes - 2 + (size - kSizes) % 2;
    return code_at(coder, static_cast<std::size_t>(at), size, value);
  }

 private:
  template <class Coder>
  std::int32_t code_at(Coder& coder, std::size_t at, int size, std::int32_t value) {
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
  /// Returns 1 if a magnitude is over twice the mean, -1 if it is below half of the mean, else 0.
  [[nodiscard]] int compare(std::int32_t value) const {
    const std::int32_t magnitude = std::min(std::abs(value), 2047) * 16;
    return magnitude > 2 * mean ? 1 : 2 * magnitude < mean ? -1 : 0;
  }
  void learn(std::int32_t value) {
    const std::int32_t magnitude = std::min(std::abs(value), 2047) * 16;
    mean = static_cast<std::uint16_t>(std::max(1, mean + (magnitude - mean) / 8));
  }
};

/// Models of a number from 0 to 63: a binary tree of decisions, highest bit first. The first four depend on a context.
template <std::size_t Contexts>
struct TreeModel {
  static constexpr std::uint32_t kMost = 63;
  std::array<std::array<BitModel, 15>, Contexts> high;
  std::array<std::array<BitModel, 3>, 16> low;

  template <class Coder>
  std::uint32_t code(Coder& coder, std::size_t context, std::uint32_t value) {
    const std::uint32_t top = branches<4>(coder, high[context], value >> 2);
    return top << 2 | branches<2>(coder, low[top], value & 3);
  }
  /// Codes a number from 0 to 15 with the models of the first four decisions.
  template <class Coder>
  std::uint32_t code_short(Coder& coder, std::size_t context, std::uint32_t value) {
    return branches<4>(coder, high[context], value);
  }

 private:
  template <int bits, std::size_t count, class Coder>
  static std::uint32_t branches(Coder& coder, std::array<BitModel, count>& models, std::uint32_t value) {
    static_assert(count == (std::size_t{1} << bits) - 1);
    std::uint32_t node = 1;
    for (int i = bits; i-- > 0;) node = node << 1 | (coder.bit(models[node - 1], (value >> i & 1) != 0) ? 1u : 0u);
    return node - (1u << bits);
  }
};

/// Models that streams with GaussianCoding::trained use.
struct TrainedModels {
  static constexpr std::size_t kContexts = 8;
  std::array<std::array<TreeModel<kContexts>, 2>, 2> gaps;  // by axis and leaf
  std::array<ShortNumberModel<8>, 2> far_gaps;              // by axis: gaps above those of the tree
  std::array<TreeModel<kContexts>, 2> opacity;              // by leaf
  std::array<SignedModel<10>, 4> place;                     // of inner Gaussians, and of leaves by axis
};

/// Models that streams without GaussianCoding::trained use.
struct UntrainedModels {
  std::array<std::array<std::array<ShortNumberModel<20>, 6>, 2>, 2> gaps;  // by axis, leaf, and the sibling's gap
  std::array<std::array<SignedModel<8>, 2>, 2> opacity;                    // by leaf and by the presence of a sibling
  std::array<SignedModel<20>, 2> place;                                    // by leaf
};

/// Models of the Gaussians of a cluster. A cluster starts with those at the end of its parent.
struct SplatModels {
  /// Constructs the models at the start of a stream.
  explicit SplatModels(bool from_table = false);

  // These members start with the table of trained models, in its order (splat_priors.inc).
  ShortNumberModel<16> children;
  std::array<BitModel, 3> leaf;                               // by the previous sibling: none, inner, leaf
  std::array<std::array<SignedModel<10>, 2>, 2> size;         // largest scale, by leaf and by the presence of a sibling
  std::array<std::array<SignedModel<10>, 3>, 2> turn, color;  // by leaf and component
  TrainedModels own;

  UntrainedModels former;
  std::array<std::array<TypicalSize, 3>, 2> color_size;
  std::array<std::array<TypicalSize, 2>, 2> scale_size, opacity_size;
  std::uint32_t trained = 0;  // 1 if the models started with the table
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
