#pragma once

#include "vrml/scene/values/field_numbers.h"
#include "vrml/syntax/parsed_text.h"

#include <array>
#include <string_view>

namespace gs::vrml {

/// Reader of field values other than nodes: single values, lists and images.
class ValueParser {
 public:
  explicit ValueParser(ParsedText& text) : text_(text) {}

  // Reads a single value of floats in the plain form that nearly all files use. Returns false and reads nothing if the
  // text has another form.
  bool plain_floats(FieldType type, FieldValue& into);
  // Parses one value that starts with `token`; its type is neither a node nor an image. An MF type gets one element.
  Step single_value(FieldType type, FieldValue& into, Token token, std::string_view name);
  /// Parses `width height components`; the pixels follow.
  Step image_head(FieldValue& into, Token token, std::string_view name);
  // Parses the content of the brackets of an MF type other than MFNode: in bulk if the text is plain, otherwise token
  // by token. If more bytes are needed, keeps the values already read.
  Step values_step();
  Step image_step();
  /// Begins the images of an MFImage; `token` is the first token of the value, at `before`.
  Step image_list_head(FieldValue& into, const Token& token, const Lexer::Position& before, std::string_view name);
  Step image_list_step();
  /// Prepares for the elements of a list that begins.
  void begin_list() { partial_count_ = 0; }

 private:
  // Reads and stores an element of at most `kMost` numbers.
  template <int kMost>
  Step numbers(FieldType type, FieldValue& into, Token token, Lexer::Position before, std::string_view name);
  Step refuse_token(FieldType type, const Token& found, const Lexer::Position& before, std::string_view name);
  bool bool_of(const Token& token, bool& value);
  // Returns false if the token is neither a number nor a Boolean of the list's type.
  bool take_element(Frame& frame, const Token& token);
  Step value_token(Frame& frame, const Token& token, const Lexer::Position& before);
  void note_url_place(const Frame* node, std::string_view name, const Token& token);
  template <class T>
  void bulk_floats(Array<T>& array);
  void bulk_integers(MFInt32& array);
  bool number_of(const Token& token, double& number);
  void cut_number(Token& token);
  String string_of(const Token& token);

  ParsedText& text_;
  FieldType number_type_ = FieldType::SFFloat;  // type of the value being read
  std::array<double, kMaxNumbers> partial_;     // numbers of an incomplete element of the list that is read
  int partial_count_ = 0;
  FieldValue image_;  // image of an MFImage that is being read
  bool has_image_ = false;
  bool said_bool_form_ = false, said_latin1_ = false, said_number_form_ = false;
};

}  // namespace gs::vrml
