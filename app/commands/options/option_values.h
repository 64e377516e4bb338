#pragma once

#include <charconv>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>

/// Parsers of option values.
namespace gs::app {

/// Parses the whole text as one number. Otherwise returns false, and `number` is unspecified.
template <class Number>
[[nodiscard]] bool read(std::string_view text, Number& number) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && !text.empty();
}

/// Parses a list of exactly numbers.size() finite numbers, such as "a,b,c" with the separator ','. Otherwise returns
/// false.
[[nodiscard]] bool read_list(std::string_view text, char separator, std::span<double> numbers);

/// Parses a non-negative integer. A suffix k, M or G, in upper or lower case, multiplies it by `step`, its square or
/// its cube. Returns false if the text is invalid or the result exceeds `most`.
[[nodiscard]] bool read_scaled(std::string_view text, std::uint64_t step, std::uint64_t most, std::uint64_t& number);
template <class Number>
[[nodiscard]] bool read_scaled(std::string_view text, std::uint64_t step, Number& scaled) {
  std::uint64_t number = 0;
  if (!read_scaled(text, step, std::numeric_limits<Number>::max(), number)) return false;
  scaled = static_cast<Number>(number);
  return true;
}
/// Parses a number of bytes, with suffixes for powers of 1024: "400k" is 409,600.
template <class Number>
[[nodiscard]] bool read_bytes(std::string_view text, Number& bytes) {
  return read_scaled(text, 1024, bytes);
}
/// Parses a number, with suffixes for powers of 1000: "400k" is 400,000.
template <class Number>
[[nodiscard]] bool read_count(std::string_view text, Number& count) {
  return read_scaled(text, 1000, count);
}
/// Parses a share from 0 to 1, or a percentage such as "30%".
[[nodiscard]] bool read_share(std::string_view text, double& share);
inline constexpr std::string_view kExpectedBytes = "expected a number of bytes, optionally with k, M or G: 400k";

/// Calls `take` with each part of a list such as "a,b,c". Stops and returns false if `take` returns false.
[[nodiscard]] bool each_of(std::string_view list, const std::function<bool(const std::string&)>& take);

}  // namespace gs::app
