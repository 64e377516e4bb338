#pragma once

#include "qnv/entropy/binary_coder.h"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::values {

// Binary range coding (FORMAT.md) of one cluster. The bytes are those of BinaryEncoder and BinaryDecoder. The coders do
// not check their buffers, so that a local copy stays in registers while it codes a cube.

/// Maximum number of bytes that the decisions about one cube, and finish(), read or write.
inline constexpr std::size_t kMostCubeBytes = 256;

/// Encoder into a buffer, which must have room for all bytes.
class RangeWriter {
 public:
  explicit RangeWriter(std::byte* to) : at_(reinterpret_cast<std::uint8_t*>(to)) {}

  /// Codes a bit that is 1 with the probability bound / range().
  void put(bool bit, std::uint32_t bound) {
    // Without a branch: half of the decisions are not predictable.
    const std::uint32_t no = bit ? 0 : ~0u;
    low_ += bound & no;
    range_ = bound + ((range_ - bound - bound) & no);
    while (range_ < 1u << 24) {
      shift();
      range_ <<= 8;
    }
  }
  [[nodiscard]] std::uint32_t range() const { return range_; }
  /// Returns the number of bytes written so far, if the first one is at `first`.
  [[nodiscard]] std::size_t size(const std::byte* first) const {
    return static_cast<std::size_t>(at_ - reinterpret_cast<const std::uint8_t*>(first));
  }
  /// Ends the bytes. Returns their number, without up to kSparedZeros trailing zeros.
  [[nodiscard]] std::size_t finish(const std::byte* first) {
    low_ = displaced::shortest_number(low_, range_);
    for (int i = 0; i < 4; ++i) shift();
    for (std::size_t i = 0; i < displaced::kSparedZeros && size(first) > 0 && at_[-1] == 0; ++i) --at_;
    return size(first);
  }

 private:
  void shift() {
    if (low_ >> 32 != 0) {
      std::uint8_t* to = at_;
      while (++*--to == 0) {
      }
    }
    *at_++ = static_cast<std::uint8_t>(low_ >> 24);
    low_ = (low_ & 0x00ffffff) << 8;
  }

  std::uint8_t* at_;
  std::uint64_t low_ = 0;  // bit 32 is a carry into bytes already written
  std::uint32_t range_ = 0xffffffff;
};

/// Decoder of any bytes. kMostCubeBytes zeros must follow them.
class RangeReader {
 public:
  explicit RangeReader(const std::byte* from) : at_(reinterpret_cast<const std::uint8_t*>(from)) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | *at_++;
  }

  [[nodiscard]] std::uint32_t range() const { return range_; }
  /// Decodes a bit that is 1 with the probability bound / range().
  bool get(std::uint32_t bound) {
    if (code_ < bound) {
      range_ = bound;
      normalise();
      return true;
    }
    code_ -= bound;
    range_ -= bound;
    normalise();
    return false;
  }
  /// Decodes the same bit without a branch, for bits that are not predictable.
  std::uint32_t get_even(std::uint32_t bound) {
    const std::uint32_t zero = code_ < bound ? 0 : ~0u;
    code_ -= bound & zero;
    range_ = bound + ((range_ - bound - bound) & zero);
    normalise();
    return zero + 1;
  }
  /// Decodes an equally likely bit.
  std::uint32_t get_bit() { return get_even(range_ >> 1); }
  /// Reports whether decoding needed more bytes than exist. `end` is their end.
  [[nodiscard]] bool exhausted(const std::byte* end) const {
    return at_ > reinterpret_cast<const std::uint8_t*>(end) + displaced::kSparedZeros;
  }

 private:
  void normalise() {
    while (range_ < 1u << 24) [[unlikely]] {
        code_ = code_ << 8 | *at_++;
        range_ <<= 8;
      }
  }

  const std::uint8_t* at_;
  std::uint32_t range_ = 0xffffffff, code_ = 0;
};

}  // namespace gs::qnv::values
