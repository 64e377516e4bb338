#pragma once

#include "vrml/syntax/tokens/lexer.h"
#include "vrml/x3d/value_text.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace gs::vrml::json {

/// Decodes a JSON string from the text between its quotes. Reads bytes that are not UTF-8 as Latin-1, and then sets
/// `was_latin1`. Keeps unknown escapes.
[[nodiscard]] std::string decode_string(std::string_view raw, bool has_escapes, bool& was_latin1);
[[nodiscard]] bool is_ascii(std::string_view text);

/// Reader of the elements of a JSON array into a field value. Numbers go from the text straight into the value. The
/// value contains all received elements at once. One thread.
class ListReader {
 public:
  /// Both must outlive the reader.
  ListReader(SceneSink& sink, x3d::ValueReader& values) : sink_(sink), values_(values) {}

  /// Reads a complete list of numbers in plain form after its opening bracket, if the lexer's window contains it and
  /// its bracket. Else returns false and reads nothing. It reads the same as the functions below.
  [[nodiscard]] bool read_short(FieldValue& into, Lexer& lexer);
  /// Reads a value that is one number or `true` or `false`, in plain form. Returns false for other values.
  [[nodiscard]] static bool read_plain_word(std::string_view word, FieldValue& into);

  /// Begins a list. `into` has the type of the field and must not move until end(). `name` is copied.
  void begin(FieldValue& into, std::string_view name, SourceLocation location);
  /// Reads numbers in plain form from the lexer's window.
  void read_plain(Lexer& lexer);
  /// Reads one element that is a word: a number, true, false or null.
  void read_word(std::string_view word, SourceLocation location);
  /// Reads one element that is a string. For numbers, the string may contain several.
  void read_string(std::string_view text, SourceLocation location);
  /// Ends the list at the position of its bracket.
  void end(SourceLocation location);

 private:
  template <class T>
  void read_floats(Lexer& lexer, Array<T>& list);
  void read_integers(Lexer& lexer, MFInt32& list);
  [[nodiscard]] double number_of(std::string_view word, SourceLocation location);
  void add_number(double number);
  void end_images(SourceLocation location);
  [[nodiscard]] std::size_t image_at(std::size_t from, SourceLocation location, SFImage& image);

  SceneSink& sink_;
  x3d::ValueReader& values_;
  FieldValue* into_ = nullptr;
  std::string name_;
  SourceLocation location_;
  std::array<double, 16> partial_{};  // numbers of an incomplete element
  std::size_t partial_count_ = 0;
  std::size_t arity_ = 0;         // numbers of an element; 0 for other types
  std::size_t count_ = 0;         // complete elements of an SF type
  std::size_t charged_ = 0;       // bytes of the value that were charged to the budget
  FieldValue words_ = MFInt32{};  // numbers of images
  bool is_image_ = false;
  bool said_ = false, said_integer_ = false;
};

}  // namespace gs::vrml::json
