#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv::displaced {

// Adaptive binary range coding (G. N. N. Martin, 1979; carries as in LZMA). Models learn from the decoded data. Small
// clusters cannot afford probability tables, or the 32 bytes of the final rANS states (rans.h). FORMAT.md, "Binary
// range coding", defines the bytes.

/// Maximum number of trailing zero bytes that an encoder omits. Decoders read zeros after the end.
inline constexpr std::size_t kSparedZeros = 8;

/// Returns the learning rates after n decisions: 65536 / (n + 3/2), rounded down.
template <std::size_t count>
constexpr std::array<std::uint16_t, count> learning_rates() {
  std::array<std::uint16_t, count> rates{};
  for (std::size_t n = 0; n < count; ++n) rates[n] = static_cast<std::uint16_t>(131072 / (2 * n + 3));
  return rates;
}

/// Adaptive probability of a yes. It learns fast at first.
struct BitModel {
  std::uint16_t one = 32768;  // probability of a 1, in 1/65536
  std::uint8_t seen = 0;      // number of decisions, at most kMaxSeen
  std::uint8_t unused = 0;    // so that models can be compared as words

  static constexpr std::uint8_t kMaxSeen = 30;
  static constexpr auto kRates = learning_rates<kMaxSeen + 1>();
  void learn(bool bit) {
    const std::int32_t target = bit ? 65535 : 0;
    const std::int32_t change = (target - one) * static_cast<std::int64_t>(kRates[seen]) >> 16;
    one = static_cast<std::uint16_t>(one + change);
    seen = static_cast<std::uint8_t>(seen + (seen < kMaxSeen ? 1 : 0));
  }
  /// Returns the probability in 1/65536, clamped away from 0 and 65536.
  [[nodiscard]] std::uint32_t probability() const { return std::clamp<std::uint32_t>(one, 64, 65536 - 64); }
};

/// Returns the number in [low, low + range) that needs the fewest bytes: that with the most trailing zeros. Decoders
/// get the same decisions from any number of this interval.
[[nodiscard]] constexpr std::uint64_t shortest_number(std::uint64_t low, std::uint32_t range) {
  for (int bits = 32; bits > 0; --bits) {
    const std::uint64_t step = std::uint64_t{1} << bits, value = (low + step - 1) / step * step;
    if (value < low + range) return value;
  }
  return low;
}

class BinaryEncoder {
 public:
  void put(BitModel& model, bool bit) {
    const auto bound = static_cast<std::uint32_t>(static_cast<std::uint64_t>(range_) * model.probability() >> 16);
    model.learn(bit);
    narrow(bit, bound);
  }
  /// Codes a decision with a fixed probability of a 1, in 1/65536. It must not be 0 or 65536.
  void put(std::uint32_t probability, bool bit) {
    narrow(bit, static_cast<std::uint32_t>(static_cast<std::uint64_t>(range_) * probability >> 16));
  }
  /// Codes `bits` equally likely bits of `value`, highest first.
  void put_bits(std::uint32_t value, int bits) {
    for (int i = bits; i-- > 0;) narrow((value >> i & 1) != 0, range_ >> 1);
  }
  /// Returns the bytes, without up to kSparedZeros trailing zeros.
  [[nodiscard]] std::vector<std::byte> finish();
  /// Returns the approximate number of bytes coded so far.
  [[nodiscard]] std::size_t size() const { return bytes_.size() + pending_; }

 private:
  void narrow(bool bit, std::uint32_t bound) {
    if (bit) {
      range_ = bound;
    } else {
      low_ += bound;
      range_ -= bound;
    }
    while (range_ < 1u << 24) {
      shift();
      range_ <<= 8;
    }
  }
  void shift();

  std::vector<std::byte> bytes_;
  std::uint64_t low_ = 0;  // bit 32 is a carry into bytes already produced
  std::uint32_t range_ = 0xffffffff;
  std::uint8_t cache_ = 0;
  std::size_t pending_ = 0;  // number of bytes of 255 after the cache; a carry would change them
  bool first_ = true;        // the cache is empty
};

/// Decoder of the output of BinaryEncoder. Other bytes give arbitrary decisions. Never reads past the end of the bytes:
/// zeros follow there, and a valid stream needs at most kSparedZeros of them.
class BinaryDecoder {
 public:
  explicit BinaryDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next();
  }
  bool get(BitModel& model) {
    const auto bound = static_cast<std::uint32_t>(static_cast<std::uint64_t>(range_) * model.probability() >> 16);
    const bool bit = decide(bound);
    model.learn(bit);
    return bit;
  }
  /// Decodes a number in unary: one decision for each of the `models`, until the first 0.
  std::size_t get_unary(std::span<BitModel> models) {
    std::uint32_t range = range_, code = code_;  // in registers
    for (std::size_t i = 0; i < models.size(); ++i) {
      BitModel& model = models.data()[i];
      const auto bound = static_cast<std::uint32_t>(static_cast<std::uint64_t>(range) * model.probability() >> 16);
      if (code >= bound) {
        model.learn(false);
        code_ = code - bound;
        range_ = range - bound;
        normalise();
        return i;
      }
      model.learn(true);
      range = bound;
      while (range < 1u << 24) [[unlikely]] {
          code = code << 8 | next();
          range <<= 8;
        }
    }
    range_ = range;
    code_ = code;
    return models.size();
  }
  bool get(std::uint32_t probability) {
    return decide(static_cast<std::uint32_t>(static_cast<std::uint64_t>(range_) * probability >> 16));
  }
  std::uint32_t get_bits(int bits) {
    std::uint32_t value = 0;
    for (int i = 0; i < bits; ++i) {
      const std::uint32_t bound = range_ >> 1;
      const std::uint32_t zero = code_ < bound ? 0 : ~0u;  // without a branch: these bits are not predictable
      code_ -= bound & zero;
      range_ = bound + ((range_ - bound - bound) & zero);
      normalise();
      value = value << 1 | (zero + 1);
    }
    return value;
  }

  /// Reports whether decoding needed more bytes than exist. The bytes are then truncated or invalid.
  [[nodiscard]] bool exhausted() const { return at_ > bytes_.size() + kSparedZeros; }
  /// Replaces the bytes by a longer version of them; their address may change. If decoding stops before unread() runs
  /// out, the result is the same as with all bytes.
  void extend(std::span<const std::byte> bytes) { bytes_ = bytes; }
  [[nodiscard]] std::size_t unread() const { return bytes_.size() - std::min(at_, bytes_.size()); }

 private:
  bool decide(std::uint32_t bound) {
    const bool bit = code_ < bound;
    if (bit) {
      range_ = bound;
    } else {
      code_ -= bound;
      range_ -= bound;
    }
    normalise();
    return bit;
  }
  void normalise() {
    while (range_ < 1u << 24) {
      code_ = code_ << 8 | next();
      range_ <<= 8;
    }
  }
  std::uint32_t next() {
    const std::size_t at = at_++;
    return at < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[at]) : 0;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint32_t range_ = 0xffffffff, code_ = 0;
};

/// Models of a number >= 0. Small numbers are unary steps, each with its own model, up to `Steps`. Larger numbers
/// continue with an Exp-Golomb code of order 0 with an adaptive prefix.
template <std::size_t Steps>
struct NumberModel {
  std::array<BitModel, Steps> more;
  std::array<BitModel, 24> prefix;

  void put(BinaryEncoder& encoder, std::uint32_t value) {
    for (std::size_t i = 0; i < Steps; ++i) {
      encoder.put(more[i], value > i);
      if (value <= i) return;
    }
    const std::uint32_t rest = value - static_cast<std::uint32_t>(Steps) + 1;
    const int bits = std::bit_width(rest) - 1;
    for (int i = 0; i < bits; ++i) encoder.put(prefix[static_cast<std::size_t>(i)], true);
    if (bits < 23) encoder.put(prefix[static_cast<std::size_t>(bits)], false);
    encoder.put_bits(rest & ((1u << bits) - 1), bits);
  }
  std::uint32_t get(BinaryDecoder& decoder) {
    const std::size_t steps = decoder.get_unary(more);
    if (steps < Steps) return static_cast<std::uint32_t>(steps);
    int bits = 0;
    while (bits < 23 && decoder.get(prefix[static_cast<std::size_t>(bits)])) ++bits;
    return (1u << bits | decoder.get_bits(bits)) - 1 + static_cast<std::uint32_t>(Steps);
  }
};

/// Maps 0, -1, 1, -2, 2, ... to 0, 1, 2, 3, 4, ...
inline std::uint32_t zigzag(std::int32_t value) {
  return static_cast<std::uint32_t>(value) << 1 ^ static_cast<std::uint32_t>(value >> 31);
}
inline std::int32_t unzigzag(std::uint32_t value) {
  return static_cast<std::int32_t>(value >> 1) ^ -static_cast<std::int32_t>(value & 1);
}

}  // namespace gs::qnv::displaced
