#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// Syntax error of a JSON text (RFC 8259), with its offset in bytes.
struct JsonProblem {
  std::size_t place = 0;
  std::string why;
};
/// Checks that a text is one JSON value. Lists and objects may be nested up to 64 levels. Returns nullopt for valid
/// JSON. Does not check that strings are valid UTF-8. Time and memory are linear in the length. Safe for untrusted
/// texts.
[[nodiscard]] std::optional<JsonProblem> check_json(std::string_view text);

enum class JsonKind : std::uint8_t { null, boolean, number, string, list, object };

/// Cursor for reading a text that check_json() has accepted, from front to back. Builds no tree; numbers are converted
/// directly to their destination. A copy of the cursor continues at the same position independently.
class JsonCursor {
 public:
  explicit JsonCursor(std::string_view text) : at_(text.data()), end_(at_ + text.size()) {}

  /// Returns the kind of the next value. Does not move.
  [[nodiscard]] JsonKind kind();

  // Each of the following functions expects a value of its kind, and moves to its end.
  [[nodiscard]] bool boolean();
  /// Reads a number as the nearest double. Infinity if it is too large.
  [[nodiscard]] double number();
  /// Reads a string and resolves its escapes. The result refers to the text or to `made`.
  [[nodiscard]] std::string_view string(std::string& made);
  /// Enters the list or object that is the next value.
  void open();
  /// Returns true if the current list or object has another value or member. At its end, leaves the list or object and
  /// returns false.
  [[nodiscard]] bool more();
  /// Reads the name of the next member. The member's value follows. The result refers to the text or to `made`.
  [[nodiscard]] std::string_view name(std::string& made);

  /// Skips a value of any kind. Returns its text.
  std::string_view skip();

 private:
  void skip_blanks();
  const char *at_, *end_;
};

/// Appends a string as JSON. Replaces invalid UTF-8 by U+FFFD.
void append_json_string(std::string& out, std::string_view text);
/// Appends a number as the shortest decimal that reads back as the same double. JSON has no NaN and infinities; these
/// become the strings "NaN", "Infinity" and "-Infinity".
void append_json_number(std::string& out, double number);
void append_json_number(std::string& out, float number);

}  // namespace gs::app
