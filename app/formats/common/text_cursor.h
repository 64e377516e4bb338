#pragma once

#include "base/diagnostic.h"

#include <fast_float/fast_float.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <system_error>

namespace gs::app {

/// Line and column counter for ascending positions in a text. Visits each byte once.
class LineCounter {
 public:
  explicit LineCounter(const char* begin) : next_(begin), line_start_(begin) {}

  /// Returns the line and column of `place`. If `place` is before the previous position, the line is that of the
  /// previous call.
  [[nodiscard]] SourceLocation location(const char* place) {
    while (next_ < place) {
      const void* found = std::memchr(next_, '\n', static_cast<std::size_t>(place - next_));
      if (!found) {
        next_ = place;
        break;
      }
      next_ = static_cast<const char*>(found) + 1;
      line_start_ = next_;
      ++line_;
    }
    const auto column = place < line_start_ ? 1 : place - line_start_ + 1;
    return {line_, static_cast<std::uint32_t>(column)};
  }

 private:
  const char* next_;
  const char* line_start_;
  std::uint32_t line_ = 1;
};

/// Position in a text, for reading forwards. Never reads at or after `end`.
struct TextCursor {
  const char* next;
  const char* end;

  TextCursor(const char* first, const char* last) : next(first), end(last) {}
  explicit TextCursor(std::span<const std::byte> bytes)
      : next(reinterpret_cast<const char*>(bytes.data())), end(next + bytes.size()) {}

  [[nodiscard]] static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  [[nodiscard]] bool at_end() const { return next == end; }

  /// Skips white space. Returns false at the end of the text.
  bool skip_space() {
    while (next < end && is_space(*next)) ++next;
    return next < end;
  }
  /// Reads the next word. Returns an empty word at the end of the text.
  [[nodiscard]] std::string_view word() {
    skip_space();
    const char* first = next;
    while (next < end && !is_space(*next)) ++next;
    return {first, static_cast<std::size_t>(next - first)};
  }
  /// Reads the rest of the line with its line end. Returns the text without the line end.
  [[nodiscard]] std::string_view line() {
    const char* first = next;
    const void* found = next < end ? std::memchr(next, '\n', static_cast<std::size_t>(end - next)) : nullptr;
    const char* stop = found ? static_cast<const char*>(found) : end;
    next = found ? stop + 1 : end;
    if (stop > first && stop[-1] == '\r') --stop;
    return {first, static_cast<std::size_t>(stop - first)};
  }
  /// Reads a number, correctly rounded. Accepts "inf" and "nan"; an overflow gives infinity. Returns false and does not
  /// move if there is no number.
  template <class Number>
  bool number(Number& value) {
    const char* first = next < end && *next == '+' ? next + 1 : next;
    Number read{};
    const auto result = fast_float::from_chars(first, end, read);
    if (result.ec != std::errc() && result.ec != std::errc::result_out_of_range) return false;
    next = result.ptr;
    value = read;
    return true;
  }
};

/// Returns `text` without white space at both ends.
[[nodiscard]] inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && TextCursor::is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && TextCursor::is_space(text.back())) text.remove_suffix(1);
  return text;
}

}  // namespace gs::app
