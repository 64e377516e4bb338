#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs {

/// Appends little-endian numbers to a byte vector.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}
  template <class Integer>
  void integer(Integer value) {
    for (std::size_t i = 0; i < sizeof(Integer); ++i)
      out_.push_back(static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i) & 255));
  }
  void f32(float value) { integer(std::bit_cast<std::uint32_t>(value)); }
  void f64(double value) { integer(std::bit_cast<std::uint64_t>(value)); }

 private:
  std::vector<std::byte>& out_;
};

/// Reads little-endian numbers from a span. Reading past the end returns zeros and makes good() false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class Integer>
  Integer integer() {
    std::uint64_t value = 0;
    if (bytes_.size() - at_ < sizeof(Integer)) {
      good_ = false;
      at_ = bytes_.size();
      return Integer{};
    }
    for (std::size_t i = 0; i < sizeof(Integer); ++i)
      value |= std::to_integer<std::uint64_t>(bytes_[at_ + i]) << (8 * i);
    at_ += sizeof(Integer);
    return static_cast<Integer>(value);
  }
  float f32() { return std::bit_cast<float>(integer<std::uint32_t>()); }
  double f64() { return std::bit_cast<double>(integer<std::uint64_t>()); }
  /// Returns the next `count` bytes; empty if fewer remain.
  std::span<const std::byte> bytes(std::size_t count) {
    if (bytes_.size() - at_ < count) {
      good_ = false;
      count = 0;
      at_ = bytes_.size();
      return {};
    }
    at_ += count;
    return bytes_.subspan(at_ - count, count);
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace gs
