#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gs::app {

/// What is wrong with a text that is no JSON (RFC 8259), and where, in bytes from its beginning.
struct JsonProblem {
  std::size_t place = 0;
  std::string why;
};
/// Nothing where the text is one value of JSON. Lists and objects lie at most 64 deep in each other. Work and memory
/// follow the length of the text. Whether strings are UTF-8 is for others to see.
[[nodiscard]] std::optional<JsonProblem> check_json(std::string_view text);

enum class JsonKind : std::uint8_t { null, boolean, number, string, list, object };

/// Reads a text that check_json has found right, from its beginning on, and makes nothing of what is not asked for:
/// thousands of numbers go straight to where they are wanted. A copy goes on from where it was made. Pure.
class JsonCursor {
 public:
  explicit JsonCursor(std::string_view text) : at_(text.data()), end_(at_ + text.size()) {}

  /// Of the value that it stands before.
  [[nodiscard]] JsonKind kind();

  // Each expects a value of its kind, and goes behind it.
  [[nodiscard]] bool boolean();
  /// The nearest double; infinite where the text has a larger one.
  [[nodiscard]] double number();
  /// With what is escaped in its place. The bytes lie in the text, or in `made`.
  [[nodiscard]] std::string_view string(std::string& made);
  /// Goes into a list or an object.
  void open();
  /// Inside one: true before the next value, or the name of a member; false behind its end.
  [[nodiscard]] bool more();
  /// The name of a member; its value comes next.
  [[nodiscard]] std::string_view name(std::string& made);

  /// Goes behind the value, whatever it is; its text.
  std::string_view skip();

 private:
  void skip_blanks();
  const char *at_, *end_;
};

/// Appends text as a string of JSON; what is no UTF-8 becomes U+FFFD.
void append_json_string(std::string& out, std::string_view text);
/// Appends a number with the fewest digits that give the same one; NaN and infinities, which JSON has not, as the
/// strings "NaN", "Infinity" and "-Infinity".
void append_json_number(std::string& out, double number);
void append_json_number(std::string& out, float number);

}  // namespace gs::app
