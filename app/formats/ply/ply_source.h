#pragma once

#include "app/formats/common/text_cursor.h"
#include "app/formats/ply/ply_header.h"
#include "base/nth_type.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>

namespace gs::app {

/// Converts a number from the file to an index. Returns kBadIndex if the number is no valid index.
template <class T>
[[nodiscard]] std::int32_t index_of(T value) {
  if constexpr (std::is_integral_v<T>)
    return std::in_range<std::int32_t>(value) && value >= 0 ? static_cast<std::int32_t>(value) : kBadIndex;
  else
    return value >= 0 && value < static_cast<T>(kBadIndex) ? static_cast<std::int32_t>(value) : kBadIndex;
}

template <class T, bool big>
[[nodiscard]] T load(const std::byte* from) {
  std::array<std::byte, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if constexpr (big != (std::endian::native == std::endian::big))
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  return std::bit_cast<T>(bytes);
}

/// Calls `f` with a value of the C++ type that corresponds to `type`.
template <class F>
decltype(auto) with_type(PlyType type, F&& f) {
  return with_nth_type<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t, std::uint32_t, float,
                       double>(static_cast<std::size_t>(type), f);
}

/// Data part of an ASCII PLY file: numbers separated by white space.
class PlyTextSource {
 public:
  static constexpr bool is_text = true;
  PlyTextSource(TextCursor cursor, const char* file) : cursor_(cursor), lines_(file) {}

  template <class Number>
  [[nodiscard]] bool read(PlyType, Number& value) {
    return cursor_.skip_space() && cursor_.number(value);
  }
  [[nodiscard]] bool read_index(PlyType, std::int32_t& value) {
    if (!cursor_.skip_space()) return false;
    std::int32_t whole = 0;
    const auto result = std::from_chars(cursor_.next, cursor_.end, whole);
    if (result.ec == std::errc() && (result.ptr == cursor_.end || TextCursor::is_space(*result.ptr))) {
      cursor_.next = result.ptr;
      value = whole >= 0 ? whole : kBadIndex;
      return true;
    }
    double number = 0;
    if (!cursor_.number(number)) return false;
    value = index_of(number);
    return true;
  }
  [[nodiscard]] bool read_indices(PlyType type, std::span<std::int32_t> values) {
    for (std::int32_t& value : values)
      if (!read_index(type, value)) return false;
    return true;
  }
  [[nodiscard]] bool skip(PlyType) {
    float ignored = 0;
    return cursor_.skip_space() && cursor_.number(ignored);
  }
  /// Returns true if the remaining text is long enough for `count` values.
  [[nodiscard]] bool may_hold(PlyType, std::uint64_t count) const { return count <= most_values(); }
  [[nodiscard]] std::uint64_t most_rows(const PlyElement& element) const {
    return element.properties.empty() ? 0 : most_values() / element.properties.size();
  }
  [[nodiscard]] SourceLocation location() { return lines_.location(cursor_.next); }

 private:
  [[nodiscard]] std::uint64_t most_values() const {
    return (static_cast<std::uint64_t>(cursor_.end - cursor_.next) + 1) / 2;
  }
  TextCursor cursor_;
  LineCounter lines_;
};

/// Data part of a binary PLY file.
template <bool big>
class PlyBinarySource {
 public:
  static constexpr bool is_text = false;
  static constexpr bool is_big = big;
  explicit PlyBinarySource(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool read(PlyType type, float& value) {
    return with_type(type, [&](auto kind) {
      using T = decltype(kind);
      if (bytes_.size() < sizeof(T)) return false;
      value = static_cast<float>(load<T, big>(bytes_.data()));
      bytes_ = bytes_.subspan(sizeof(T));
      return true;
    });
  }
  [[nodiscard]] bool read_index(PlyType type, std::int32_t& value) { return read_indices(type, {&value, 1}); }
  [[nodiscard]] bool read_indices(PlyType type, std::span<std::int32_t> values) {
    return with_type(type, [&](auto kind) {
      using T = decltype(kind);
      if (bytes_.size() / sizeof(T) < values.size()) return false;
      const std::byte* from = bytes_.data();
      for (std::int32_t& value : values) {
        value = index_of(load<T, big>(from));
        from += sizeof(T);
      }
      bytes_ = bytes_.subspan(values.size() * sizeof(T));
      return true;
    });
  }
  [[nodiscard]] bool skip(PlyType type) {
    if (bytes_.size() < size_of(type)) return false;
    bytes_ = bytes_.subspan(size_of(type));
    return true;
  }
  [[nodiscard]] bool may_hold(PlyType type, std::uint64_t count) const {
    return count <= bytes_.size() / size_of(type);
  }
  [[nodiscard]] std::uint64_t most_rows(const PlyElement& element) const {
    const std::size_t row = element.least_row_bytes();
    return row == 0 ? 0 : bytes_.size() / row;
  }
  [[nodiscard]] SourceLocation location() { return {}; }
  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }
  void advance(std::size_t count) { bytes_ = bytes_.subspan(count); }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace gs::app
