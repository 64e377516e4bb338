#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::net {

/// Writes numbers in network order (big-endian).
class NetworkWriter {
 public:
  explicit NetworkWriter(std::vector<std::byte>& out) : out_(out) {}
  template <class Integer>
  void integer(Integer value) {
    for (std::size_t i = sizeof(Integer); i-- > 0;)
      out_.push_back(static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i) & 255));
  }
  void bytes(std::span<const std::byte> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }

 private:
  std::vector<std::byte>& out_;
};

/// Reads numbers in network order. After the end, returns zeros, and `good` returns false.
class NetworkReader {
 public:
  explicit NetworkReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class Integer>
  Integer integer() {
    if (bytes_.size() < sizeof(Integer)) {
      fail();
      return Integer{};
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) value = value << 8 | std::to_integer<std::uint64_t>(bytes_[i]);
    bytes_ = bytes_.subspan(sizeof(Integer));
    return static_cast<Integer>(value);
  }
  /// Returns the next bytes, or an empty span if fewer are left.
  std::span<const std::byte> bytes(std::size_t count) {
    if (bytes_.size() < count) {
      fail();
      return {};
    }
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] std::span<const std::byte> rest() const { return bytes_; }

 private:
  void fail() {
    good_ = false;
    bytes_ = {};
  }
  std::span<const std::byte> bytes_;
  bool good_ = true;
};

}  // namespace gs::net
