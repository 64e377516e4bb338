#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// Numbers of any bit width, packed without gaps, lowest bit first; and the checksums of chunk heads and records.
// FORMAT.md, "Outlines payload".
namespace gs::qnv::outline {

/// Maps 0, -1, 1, -2, 2, ... to 0, 1, 2, 3, 4, ...
[[nodiscard]] constexpr std::uint64_t zigzag(std::int64_t value) {
  return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}
[[nodiscard]] constexpr std::int64_t unzigzag(std::uint64_t value) {
  return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
}

/// Maximum order of an Exp-Golomb code.
constexpr int kMaxOrder = 31;
/// Maximum bits of a value in an Exp-Golomb code: values are below 2^40.
constexpr int kMaxValueBits = 40;

/// Returns the length of an Exp-Golomb code in bits (J. Teuhola 1978). Let b be the number of bits of value + 2^order.
/// The code is b - order - 1 zeros, a one, and the lowest b - 1 bits of value + 2^order.
[[nodiscard]] constexpr int golomb_bits(std::uint64_t value, int order) {
  return 2 * static_cast<int>(std::bit_width(value + (std::uint64_t{1} << order))) - order - 1;
}

class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& out) : out_(out) {}
  /// Writes the lowest `width` bits of `value`; `width` is at most 40.
  void bits(std::uint64_t value, int width) {
    waiting_ |= (value & ((std::uint64_t{1} << width) - 1)) << count_;
    for (count_ += width; count_ >= 8; count_ -= 8, waiting_ >>= 8)
      out_.push_back(static_cast<std::byte>(waiting_ & 255));
  }
  void flag(bool value) { bits(value ? 1 : 0, 1); }
  void golomb(std::uint64_t value, int order) {
    const std::uint64_t sum = value + (std::uint64_t{1} << order);
    const int width = static_cast<int>(std::bit_width(sum));
    bits(0, width - order - 1);
    flag(true);
    bits(sum, width - 1);
  }
  /// Fills the rest of the last byte with zeros.
  void align() {
    if (count_ > 0) bits(0, 8 - count_);
  }

 private:
  std::vector<std::byte>& out_;
  std::uint64_t waiting_ = 0;
  int count_ = 0;
};

/// Reader of packed numbers. Reading past the end returns zeros and makes good() false.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  /// Reads a number of `width` bits, at most 40.
  std::uint64_t bits(int width) {
    while (count_ < width) {
      if (at_ == bytes_.size()) {
        good_ = false;
        count_ = 0;
        waiting_ = 0;
        return 0;
      }
      waiting_ |= std::to_integer<std::uint64_t>(bytes_[at_++]) << count_;
      count_ += 8;
    }
    const std::uint64_t value = waiting_ & ((std::uint64_t{1} << width) - 1);
    waiting_ >>= width;
    count_ -= width;
    return value;
  }
  bool flag() { return bits(1) != 0; }
  std::uint64_t golomb(int order) {
    int zeros = 0;
    while (good_ && !flag())
      if (++zeros + order >= kMaxValueBits) good_ = false;
    if (!good_) return 0;
    const int width = zeros + order;
    return (bits(width) | std::uint64_t{1} << width) - (std::uint64_t{1} << order);
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::size_t left() const { return static_cast<std::size_t>(count_) + 8 * (bytes_.size() - at_); }
  /// Reports whether everything except the padding of the last byte was read, and this padding is 0.
  [[nodiscard]] bool at_end() const { return good_ && at_ == bytes_.size() && count_ < 8 && waiting_ == 0; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint64_t waiting_ = 0;
  int count_ = 0;
  bool good_ = true;
};

/// Returns the CRC-8 of `bytes`: polynomial 07, highest bit first, initial value FF, no final inversion.
[[nodiscard]] std::uint8_t crc8(std::span<const std::byte> bytes);
/// Returns the CRC-16 of `bytes`: polynomial 1021, highest bit first, initial value FFFF, no final inversion.
[[nodiscard]] std::uint16_t crc16(std::span<const std::byte> bytes, std::uint16_t from = 0xffff);

}  // namespace gs::qnv::outline
