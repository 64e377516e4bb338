#pragma once

#include <charconv>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>

/// Values of options as people write them.
namespace gs::app {

/// A whole text as a number; false, with `number` unspecified, for anything else.
template <class Number>
[[nodiscard]] bool read(std::string_view text, Number& number) {
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() && result.ptr == text.data() + text.size() && !text.empty();
}

/// "a,b,c" as that many finite numbers.
[[nodiscard]] bool read_list(std::string_view text, char separator, std::span<double> numbers);

/// A whole number, with a letter behind it that multiplies it: k, M and G in any case, by powers of `step`. False for
/// anything else, and for what is larger than `most`.
[[nodiscard]] bool read_scaled(std::string_view text, std::uint64_t step, std::uint64_t most, std::uint64_t& number);
/// Bytes: "400k" are 409,600.
template <class Number>
[[nodiscard]] bool read_bytes(std::string_view text, Number& bytes) {
  std::uint64_t number = 0;
  if (!read_scaled(text, 1024, std::numeric_limits<Number>::max(), number)) return false;
  bytes = static_cast<Number>(number);
  return true;
}
/// Things or bits: "400k" are 400,000.
template <class Number>
[[nodiscard]] bool read_count(std::string_view text, Number& count) {
  std::uint64_t number = 0;
  if (!read_scaled(text, 1000, std::numeric_limits<Number>::max(), number)) return false;
  count = static_cast<Number>(number);
  return true;
}
inline constexpr std::string_view kExpectedBytes = "expected a number of bytes, or with k, M or G behind it: 400k";

/// Gives the parts of "a,b,c" to `take`; false when one of them is not taken.
[[nodiscard]] bool each_of(std::string_view list, const std::function<bool(const std::string&)>& take);

}  // namespace gs::app
