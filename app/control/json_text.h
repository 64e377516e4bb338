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
/// Checks that a text is one JSON value. Lists and objects nest at most 64 levels. Returns nullopt for valid JSON. Time
/// and memory are linear in the length. Does not check that strings are UTF-8. Safe for untrusted texts.
[[nodiscard]] std::optional<JsonProblem> check_json(std::string_view text);

enum class JsonKind : std::uint8_t { null, boolean, number, string, list, object };

/// Forward cursor over a text that check_json() has accepted. It builds no tree, so thousands of numbers are read
/// directly into their destination. A copy continues at its position. Pure.
class JsonCursor {
 public:
  explicit JsonCursor(std::string_view text) : at_(text.data()), end_(at_ + text.size()) {}

  /// Returns the kind of the next value.
  [[nodiscard]] JsonKind kind();

  // Each of these expects a value of its kind and moves past it.
  [[nodiscard]] bool boolean();
  /// Returns the nearest double; infinity if the number is too large.
  [[nodiscard]] double number();
  /// Returns the string with escapes resolved. The bytes are in the text or in `made`.
  [[nodiscard]] std::string_view string(std::string& made);
  /// Enters a list or an object.
  void open();
  /// Returns true before the next value or member name; moves past the end of the list or object and returns false
  /// there.
  [[nodiscard]] bool more();
  /// Returns the name of a member; its value is next.
  [[nodiscard]] std::string_view name(std::string& made);

  /// Moves past a value of any kind and returns its text.
  std::string_view skip();

 private:
  void skip_blanks();
  const char *at_, *end_;
};

/// Appends a JSON string. Invalid UTF-8 becomes U+FFFD.
void append_json_string(std::string& out, std::string_view text);
/// Appends the shortest decimal number that reads back as the same value. NaN and infinities, which JSON lacks, become
/// the strings "NaN", "Infinity" and "-Infinity".
void append_json_number(std::string& out, double number);
void append_json_number(std::string& out, float number);

}  // namespace gs::app
