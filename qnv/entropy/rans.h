#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace gs::qnv {

// Range asymmetric numeral systems (Duda 2013): eight interleaved 32-bit states, refilled by 16 bits at a time, with
// 12-bit probabilities. FORMAT.md, "Entropy coding", defines the bytes.

constexpr int kRansBits = 12;
constexpr std::uint32_t kRansTotal = 1u << kRansBits;
constexpr std::uint32_t kRansLow = 1u << 16;
constexpr std::size_t kRansLanes = 8;

/// Encoder that collects decisions in the order in which a decoder reads them.
class RansEncoder {
 public:
  /// Adds a symbol with the interval [start, start + frequency) of 0..4095. `lane` < 8 selects the state that codes the
  /// symbol.
  void put(std::size_t lane, std::uint32_t start, std::uint32_t frequency) {
    entries_.push_back(
        {static_cast<std::uint16_t>(start), static_cast<std::uint16_t>(frequency), static_cast<std::uint8_t>(lane)});
  }
  /// Adds the lowest `bits` bits of `value`, at most 12; they are equally likely.
  void put_bits(std::size_t lane, std::uint32_t value, int bits) {
    put(lane, value << (kRansBits - bits), 1u << (kRansBits - bits));
  }
  /// Returns the bytes: eight states, then 16-bit words. Returns an empty list if no decision was added.
  [[nodiscard]] std::vector<std::byte> finish() const;

 private:
  struct Entry {
    std::uint16_t start, frequency;
    std::uint8_t lane;
  };
  std::vector<Entry> entries_;
};

/// Decoder of the output of RansEncoder. Never reads past the bytes and their padding: missing words are read as zero,
/// and finished() then returns false. Branch-free, because refills are unpredictable.
class RansDecoder {
 public:
  /// Number of readable bytes that the caller must provide after the end of `bytes`. Their content does not matter.
  static constexpr std::size_t kPadding = 16;

  explicit RansDecoder(std::span<const std::byte> bytes) : bytes_(bytes.data()), size_(bytes.size()) {
    for (std::uint32_t& state : states_) {
      state = word();
      state |= static_cast<std::uint32_t>(word()) << 16;
    }
  }

  [[nodiscard]] std::uint32_t peek(std::size_t lane) const { return states_[lane] & (kRansTotal - 1); }
  void advance(std::size_t lane, std::uint32_t start, std::uint32_t frequency) {
    const std::uint32_t x = frequency * (states_[lane] >> kRansBits) + peek(lane) - start;
    std::uint16_t w;
    std::memcpy(&w, bytes_ + (next_ < size_ ? next_ : size_), 2);
    const bool refill = x < kRansLow;
    states_[lane] = refill ? x << 16 | w : x;
    next_ += refill ? 2 : 0;
  }
  std::uint32_t get_bits(std::size_t lane, int bits) {
    const std::uint32_t value = peek(lane) >> (kRansBits - bits);
    advance(lane, value << (kRansBits - bits), 1u << (kRansBits - bits));
    return value;
  }
  /// Reports whether all bytes were read and every state has returned to its initial value.
  [[nodiscard]] bool finished() const {
    for (const std::uint32_t state : states_)
      if (state != kRansLow) return false;
    return next_ == size_;
  }

 private:
  std::uint16_t word() {
    std::uint16_t w = 0;
    if (next_ + 2 <= size_) std::memcpy(&w, bytes_ + next_, 2);
    next_ += 2;
    return w;
  }

  // packed_avx2.cpp loads and stores these members as whole vectors.
  friend struct RansVector;
  const std::byte* bytes_;
  std::size_t size_, next_ = 0;
  std::uint32_t states_[kRansLanes];
};

inline std::vector<std::byte> RansEncoder::finish() const {
  std::uint32_t states[kRansLanes] = {kRansLow, kRansLow, kRansLow, kRansLow, kRansLow, kRansLow, kRansLow, kRansLow};
  std::vector<std::uint16_t> words;
  for (std::size_t i = entries_.size(); i-- > 0;) {
    const Entry& e = entries_[i];
    std::uint32_t& x = states[e.lane];
    // A state needs at most one word per symbol, because refills have 16 bits.
    if (x >= static_cast<std::uint64_t>(e.frequency) << (32 - kRansBits)) {
      words.push_back(static_cast<std::uint16_t>(x));
      x >>= 16;
    }
    x = (x / e.frequency << kRansBits) + x % e.frequency + e.start;
  }
  std::vector<std::byte> out;
  out.reserve(4 * kRansLanes + 2 * words.size());
  const auto put_word = [&](std::uint32_t w) {
    out.push_back(static_cast<std::byte>(w & 255));
    out.push_back(static_cast<std::byte>(w >> 8 & 255));
  };
  for (const std::uint32_t state : states) {
    put_word(state);
    put_word(state >> 16);
  }
  for (std::size_t i = words.size(); i-- > 0;) put_word(words[i]);
  return out;
}

}  // namespace gs::qnv
