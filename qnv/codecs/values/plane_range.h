#pragma once

#include "qnv/entropy/binary_coder.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace gs::qnv::values {

// Binary range coding (FORMAT.md) of one cluster. The bytes are those of BinaryEncoder and BinaryDecoder, with fixed
// buffers: a local copy of a coder stays in registers while it codes a cube.

/// Encoder into a buffer, which must have room for all bytes.
class RangeWriter {
 public:
  explicit RangeWriter(std::byte* to) : first_(reinterpret_cast<std::uint8_t*>(to)), at_(first_) {}

  /// Codes a decision with a probability of a 1, in 1/65536.
  void put(std::uint32_t probability, bool bit) {
    narrow(bit, static_cast<std::uint32_t>(std::uint64_t{range_} * probability >> 16));
  }
  void put_bit(bool bit) { narrow(bit, range_ >> 1); }
  /// Returns the approximate number of bytes coded so far.
  [[nodiscard]] std::size_t size() const { return at_ > first_ ? static_cast<std::size_t>(at_ - first_) - 1 : 0; }
  /// Ends the bytes and returns their number, without up to kSparedZeros trailing zeros. Writes at most four more bytes.
  [[nodiscard]] std::size_t finish() {
    // Any number in the interval decodes correctly. The number with the most trailing zeros gives the fewest bytes.
    const std::uint64_t end = low_ + range_;
    for (int bits = 32; bits >= 0; --bits) {
      const std::uint64_t step = std::uint64_t{1} << bits;
      const std::uint64_t value = (low_ + step - 1) / step * step;
      if (value < end) {
        low_ = value;
        break;
      }
    }
    for (int i = 0; i < 4; ++i) shift();
    for (std::size_t i = 0; i < displaced::kSparedZeros && at_ > first_ && at_[-1] == 0; ++i) --at_;
    return static_cast<std::size_t>(at_ - first_);
  }

 private:
  void narrow(bool bit, std::uint32_t bound) {
    // Without a branch: half of the decisions are not predictable.
    const std::uint32_t no = bit ? 0 : ~0u;
    low_ += bound & no;
    range_ = bound + ((range_ - bound - bound) & no);
    while (range_ < 1u << 24) {
      shift();
      range_ <<= 8;
    }
  }
  void shift() {
    if (low_ >> 32 != 0) {
      std::uint8_t* to = at_;
      while (++*--to == 0) {
      }
    }
    *at_++ = static_cast<std::uint8_t>(low_ >> 24);
    low_ = (low_ & 0x00ffffff) << 8;
  }

  std::uint8_t *first_, *at_;
  std::uint64_t low_ = 0;  // bit 32 is a carry into bytes already written
  std::uint32_t range_ = 0xffffffff;
};

/// Decoder of any bytes. Zeros follow them.
class RangeReader {
 public:
  explicit RangeReader(std::span<const std::byte> bytes)
      : at_(reinterpret_cast<const std::uint8_t*>(bytes.data())), end_(at_ + bytes.size()) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next();
  }

  /// Decodes a decision with a probability of a 1, in 1/65536.
  bool get(std::uint32_t probability) {
    const auto bound = static_cast<std::uint32_t>(std::uint64_t{range_} * probability >> 16);
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
  /// Decodes an equally likely bit.
  std::uint32_t get_bit() {
    const std::uint32_t bound = range_ >> 1;
    const std::uint32_t zero = code_ < bound ? 0 : ~0u;  // without a branch: these bits are not predictable
    code_ -= bound & zero;
    range_ = bound + ((range_ - bound - bound) & zero);
    normalise();
    return zero + 1;
  }
  /// Reports whether decoding needed more bytes than exist.
  [[nodiscard]] bool exhausted() const { return missing_ > displaced::kSparedZeros; }

 private:
  void normalise() {
    while (range_ < 1u << 24) {
      code_ = code_ << 8 | next();
      range_ <<= 8;
    }
  }
  std::uint32_t next() {
    if (at_ < end_) return *at_++;
    ++missing_;
    return 0;
  }

  const std::uint8_t *at_, *end_;
  std::uint32_t range_ = 0xffffffff, code_ = 0;
  std::uint32_t missing_ = 0;  // number of zeros read after the end
};

}  // namespace gs::qnv::values
