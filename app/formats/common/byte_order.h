#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace gs::app {

/// Loads a little-endian number.
template <class T>
requires std::is_arithmetic_v<T>
[[nodiscard]] T load_little(const std::byte* from) {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

/// Appends a number in little-endian order.
template <class T>
requires std::is_arithmetic_v<T>
void put_little(std::vector<std::byte>& to, T value) {
  static_assert(std::endian::native == std::endian::little);
  const auto* raw = reinterpret_cast<const std::byte*>(&value);
  to.insert(to.end(), raw, raw + sizeof(T));
}

/// Converts an IEEE 754 binary16 number.
[[nodiscard]] inline float float_of_half(std::uint16_t half) {
  const float sign = (half & 0x8000) ? -1.0f : 1.0f;
  const int exponent = half >> 10 & 31;
  const auto fraction = static_cast<float>(half & 1023);
  if (exponent == 31) return fraction == 0 ? sign * INFINITY : NAN;
  if (exponent == 0) return sign * std::ldexp(fraction, -24);
  return sign * std::ldexp(1024 + fraction, exponent - 25);
}

}  // namespace gs::app
