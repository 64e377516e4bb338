#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace gs::qnv {

// Range asymmetric numeral systems (Duda 2013) with eight interleaved states of 32 bits that are refilled by 16 bits,
// and probabilities of 12 bits. The bytes are defined in FORMAT.md, "Entropy coding".

constexpr int kRansBits = 12;
constexpr std::uint32_t kRansTotal = 1u << kRansBits;
constexpr std::uint32_t kRansLow = 1u << 16;
constexpr std::size_t kRansLanes = 8;

/// Collects decisions in the order in which the decoder makes them.
class RansEncoder {
 public:
  /// A symbol that owns [start, start + frequency) of 0..4095. `lane` < 8 is the state that codes it.
  void put(std::size_t lane, std::uint32_t start, std::uint32_t frequency) {
    entries_.push_back(
        {static_cast<std::uint16_t>(start), static_cast<std::uint16_t>(frequency), static_cast<std::uint8_t>(lane)});
  }
  /// `bits` (at most 12) equally likely bits.
  void put_bits(std::size_t lane, std::uint32_t value, int bits) {
    put(lane, value << (kRansBits - bits), 1u << (kRansBits - bits));
  }
  /// The bytes: eight states, then words of 16 bits. Empty when nothing was put.
  [[nodiscard]] std::vector<std::byte> finish() const;

 private:
  struct Entry {
    std::uint16_t start, frequency;
    std::uint8_t lane;
  };
  std::vector<Entry> entries_;
};

/// Reads what RansEncoder wrote. Never reads outside its bytes: behind their end come zeros, and `finished` tells.
/// Without branches, since whether a state wants a word cannot be foreseen.
class RansDecoder {
 public:
  /// Bytes that must stay readable behind the end of `bytes`; what they hold does not matter.
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
  /// Whether everything was read and every state is back where the encoder began.
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

  // Members are read and written whole by the vector code in packed_avx2.cpp.
  friend struct RansVector;
  const std::byte* bytes_;
  std::size_t size_, next_ = 0;
  std::uint32_t states_[kRansLanes];
};

inline std::vector<std::byte> RansEncoder::finish() const {
  std::uint32_t states[kRansLanes] = {kRansLow, kRansLow, kRansLow, kRansLow,
                                      kRansLow, kRansLow, kRansLow, kRansLow};
  std::vector<std::uint16_t> words;
  for (std::size_t i = entries_.size(); i-- > 0;) {
    const Entry& e = entries_[i];
    std::uint32_t& x = states[e.lane];
    // With 16-bit refills a state needs at most one word a symbol.
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
