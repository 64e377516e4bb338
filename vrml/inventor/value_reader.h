#pragma once

#include "vrml/inventor/item.h"
#include "vrml/syntax/scene_sink.h"
#include "vrml/syntax/tokens/lexer.h"

#include <optional>
#include <string>
#include <string_view>

namespace gs::vrml::inventor {

/// Returns the field type with this name: "SFVec3f", "MFLong", ...
[[nodiscard]] std::optional<ValueType> value_type_named(std::string_view name);
/// Returns the value of a field without a default.
[[nodiscard]] FieldValue initial_of(const ValueType& type);

/// Reader of field values other than nodes. The window of the lexer must contain the rest of the text. Reports invalid
/// values, and skips them. One thread.
class ValueReader {
 public:
  ValueReader(Lexer& lexer, SceneSink& sink) : lexer_(lexer), sink_(sink) {}

  /// Reads a value. `name` is the name of the field, for messages.
  void read(const ValueType& type, FieldValue& into, std::string_view name);
  /// Skips the bracket that was just opened, up to its end.
  void skip_brackets();

 private:
  void read_image(FieldValue& into);
  void read_words(const ValueType& type, FieldValue& into);
  void read_numbers(const ValueType& type, FieldValue& into);
  template <class T, class Bulk>
  void read_list(Array<T>& list, FieldValue& into, std::size_t wanted, bool bracketed, Bulk bulk);
  template <class Number>
  [[nodiscard]] bool number(Number& value);
  [[nodiscard]] bool number_follows();
  [[nodiscard]] bool open_bracket();
  [[nodiscard]] String text(const Token& token);
  [[nodiscard]] String mask(const Token& first);
  void cut(const Token& token, std::size_t length);
  void unexpected(const Token& token, const std::string& what);

  Lexer& lexer_;
  SceneSink& sink_;
  std::string_view name_;
  bool said_latin1_ = false, said_bare_ = false, said_unbracketed_ = false;
  SourceLocation bad_at_;  // last reported token
};

}  // namespace gs::vrml::inventor
