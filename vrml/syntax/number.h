#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gs::vrml {

/// Reads the whole of `text` as a number of VRML97 clause 5 (5.5 `sffloatValue`, 5.6 `sfint32Value`):
/// decimal with optional sign, fraction and exponent, correctly rounded; integers also as 0x hex,
/// whose 32 bits are taken as they are. False, and `value` untouched, where it is none. A float too
/// large becomes an infinity, one too small zero. Safe for untrusted input.
[[nodiscard]] bool parse_number(std::string_view text, float& value);
[[nodiscard]] bool parse_number(std::string_view text, double& value);
[[nodiscard]] bool parse_number(std::string_view text, std::int32_t& value);

/// The length of the longest number that `text` begins with; 0 where it begins with none.
[[nodiscard]] std::size_t number_length(std::string_view text);

/// Where a bulk read has come to.
struct NumberRun {
  const char* next;        // first byte that was not used; never inside a number
  std::size_t count;       // numbers written
  std::size_t lines;       // line feeds passed
  const char* line_start;  // behind the last of them; null when there was none
};

/// Reads decimal numbers parted by blanks, tabs, commas and line ends (LF or CRLF), writing at most
/// `capacity` of them to `out`; what is behind the last number there, up to `capacity`, may be overwritten.
/// Stops, without an error, in front of anything else: the slow path knows what to do with comments, bare
/// carriage returns, hexadecimal integers, brackets and rubbish. Looks at no byte at or after `end`, and
/// leaves a number there of which it cannot see the end. Correctly rounded; the speed of the parser is the
/// speed of these loops. Safe for untrusted input.
[[nodiscard]] NumberRun parse_floats(const char* begin, const char* end, float* out, std::size_t capacity);
[[nodiscard]] NumberRun parse_integers(const char* begin, const char* end, std::int32_t* out, std::size_t capacity);

}  // namespace gs::vrml
