#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gs::vrml {

/// Parses all of `text` as a number of VRML97 clause 5 (5.5 `sffloatValue`, 5.6 `sfint32Value`): decimal with optional
/// sign, fraction and exponent, correctly rounded. Integers may be hexadecimal (0x); the 32 bits do not change. Returns
/// false for other text, and then does not change `value`. Floats that are too large become infinity; those that are
/// too small become zero. Safe for untrusted text.
[[nodiscard]] bool parse_number(std::string_view text, float& value);
[[nodiscard]] bool parse_number(std::string_view text, double& value);
[[nodiscard]] bool parse_number(std::string_view text, std::int32_t& value);

/// Returns the length of the longest number at the start of `text`; 0 if `text` does not start with a number.
[[nodiscard]] std::size_t number_length(std::string_view text);

/// State of a bulk read.
struct NumberRun {
  const char* next;  // first byte that was not read; never inside a number
  std::size_t count;  // number of values written
  std::size_t lines;  // number of line feeds read
  const char* line_start;  // start of the line after the last line feed; null if no line feed was read
};

/// Parses decimal numbers separated by blanks, tabs, commas and line ends (LF or CRLF) into `out`, at most `capacity`
/// of them. May overwrite elements after the last number, up to `capacity`. Stops without an error before other bytes:
/// the slow path handles comments, single carriage returns, hexadecimal integers, brackets and invalid text. Never
/// reads at or after `end`. Stops before a number that may continue there. Results are correctly rounded. The speed of
/// the parser depends mainly on these loops. Safe for untrusted text. The next function does the same for integers.
[[nodiscard]] NumberRun parse_floats(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun parse_integers(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

}  // namespace gs::vrml
