#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gs::vrml {

/// Parses all of `text` as a number of VRML97 clause 5 (5.5 `sffloatValue`, 5.6 `sfint32Value`): decimal with optional
/// sign, fraction and exponent, correctly rounded. Integers may be 0x hex; its 32 bits are taken unchanged. Returns
/// false and leaves `value` unchanged for other text. Floats that are too large become infinity, those too small zero.
/// Accepts untrusted input.
[[nodiscard]] bool parse_number(std::string_view text, float& value);
[[nodiscard]] bool parse_number(std::string_view text, double& value);
[[nodiscard]] bool parse_number(std::string_view text, std::int32_t& value);

/// Returns the length of the longest number at the start of `text`; 0 if there is none.
[[nodiscard]] std::size_t number_length(std::string_view text);

/// Position of a bulk read.
struct NumberRun {
  const char* next;        // first unused byte; never inside a number
  std::size_t count;       // numbers written
  std::size_t lines;       // line feeds consumed
  const char* line_start;  // after the last line feed; null if there was none
};

/// Parse decimal numbers separated by blanks, tabs, commas and line ends (LF or CRLF), at most `capacity` of them, into
/// `out`; elements after the last number, up to `capacity`, may be overwritten. Stop without an error before anything
/// else: the slow path handles comments, bare carriage returns, hexadecimal integers, brackets and invalid text. Never
/// read at or after `end`, and stop before a number that may continue there. Correctly rounded. These loops determine
/// the speed of the parser. Accept untrusted input.
[[nodiscard]] NumberRun parse_floats(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun parse_integers(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

}  // namespace gs::vrml
