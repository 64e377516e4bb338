#pragma once

#include "vrml/syntax/scene_sink.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace gs::vrml::x3d {

/// Text of a field's value, and its position.
struct ValueText {
  std::string_view text;
  SourceLocation location;  // of the first byte
  std::string_view name;    // name of the field, for diagnostics
};

/// Reader of field values in the notation of the XML encoding (ISO/IEC 19776-1 clause 5): numbers between blanks and
/// commas, `true` and `false`, strings in quotes. Safe for untrusted text. One thread.
class ValueReader {
 public:
  /// `sink` must outlive the reader.
  explicit ValueReader(SceneSink& sink) : sink_(sink) {}

  /// Reads the complete text of a value. `into` has the type of the field, which is not a node. After an error,
  /// which it reports, the value is unchanged or has fewer elements.
  void read(const ValueText& value, FieldValue& into);

  /// Converts UTF-8 or Latin-1 to a string, and charges it to the budget.
  [[nodiscard]] String string_of(std::string_view text, SourceLocation location);
  /// Reports whether the word means true. Sets `is_boolean` to false if it is no boolean. Reports words that are not
  /// `true` or `false`.
  [[nodiscard]] bool boolean_of(std::string_view word, SourceLocation location, bool& is_boolean);

 private:
  template <class T>
  void read_element(T& element);
  template <class T>
  void read_list(Array<T>& list, FieldValue& whole);
  template <class Number>
  [[nodiscard]] std::size_t read_numbers(Number* out, std::size_t count);
  template <class Number>
  [[nodiscard]] std::size_t read_short(Number* out, std::size_t count);
  template <class Number>
  [[nodiscard]] Number slow_number(std::string_view word);
  [[nodiscard]] bool read_image(SFImage& image);
  void read_strings(MFString& strings);
  [[nodiscard]] std::string_view next_word();
  void skip_separators();
  void check_end();
  [[nodiscard]] SourceLocation location_of(const char* p);

  SceneSink& sink_;
  const ValueText* value_ = nullptr;  // value that is read
  const char* next_ = nullptr;
  const char* end_ = nullptr;
  const char* located_ = nullptr;  // position of `location_`: the last that was asked for
  SourceLocation location_;
  std::string scratch_;
  std::size_t charged_ = 0;   // bytes of this value that were charged to the budget
  bool said_number_ = false;  // a problem of a number in this value was reported
  bool said_boolean_ = false, said_latin1_ = false, said_integer_ = false;
};

/// Returns the number of line feeds in a text.
[[nodiscard]] std::uint32_t count_lines(std::string_view text);

/// Returns the position of `p` in a text that begins at `start`.
[[nodiscard]] SourceLocation location_in(std::string_view text, SourceLocation start, const char* p);

/// Decodes an SFString of a list: replaces `\"` and `\\`.
void unescape(std::string_view raw, std::string& out);

}  // namespace gs::vrml::x3d
