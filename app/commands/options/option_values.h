#pragma once

#include <charconv>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>

/// Values of options as users write them.
namespace gs::app {

/// Parses the whole text as a number. Returns false for anything else; `number` is then unspecified.
template <class Number>
[[nodiscard]] bool read(std::string_view text, Number& number) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && !text.empty();
}

/// Parses "a,b,c" as numbers.size() finite numbers. Returns false for anything else.
[[nodiscard]] bool read_list(std::string_view text, char separator, std::span<double> numbers);

/// Parses a whole number. A suffix k, M or G in any case multiplies it by a power of `step`. Returns false for anything
/// else, and for results larger than `most`.
[[nodiscard]] bool read_scaled(std::string_view text, std::uint64_t step, std::uint64_t most, std::uint64_t& number);
/// Parses a number of bytes: "400k" is 409,600.
template <class Number>
[[nodiscard]] bool read_bytes(std::string_view text, Number& bytes) {
  std::uint64_t number = 0;
  if (!read_scaled(text, 1024, std::numeric_limits<Number>::max(), number)) return false;
  bytes = static_cast<Number>(number);
  return true;
}
/// Parses a count: "400k" is 400,000.
template <class Number>
[[nodiscard]] bool read_count(std::string_view text, Number& count) {
  std::uint64_t number = 0;
  if (!read_scaled(text, 1000, std::numeric_limits<Number>::max(), number)) return false;
  count = static_cast<Number>(number);
  return true;
}
inline constexpr std::string_view kExpectedBytes = "expected a number of bytes, optionally with k, M or G: 400k";

/// Passes the parts of "a,b,c" to `take`. Returns false as soon as `take` does.
[[nodiscard]] bool each_of(std::string_view list, const std::function<bool(const std::string&)>& take);

}  // namespace gs::app
