#pragma once

#include "vrml/syntax/parsed_text.h"

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

 private:
  Step value_token(Frame& frame, const Token& token, const Lexer::Position& before);
  void note_url_place(const Frame* node, std::string_view name, const Token& token);
  template <class T>
  void bulk_floats(Frame& frame, Array<T>& array);
  void bulk_integers(MFInt32& array);
  bool number_of(const Token& token, double& number);
  void cut_number(Token& token);
  String string_of(const Token& token);

  ParsedText& text_;
  FieldType number_type_ = FieldType::SFFloat;  // type of the value being read
  bool said_bool_form_ = false, said_latin1_ = false, said_number_form_ = false;
};

}  // namespace gs::vrml
