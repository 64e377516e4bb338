#pragma once

#include "vrml/syntax/numbers/number.h"
#include "vrml/syntax/scene_sink.h"

#include <cctype>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Reader of worlds as S-expressions: a second grammar for SceneSink.
///
///     (Type field...)  (def NAME (Type field...))  (use NAME)       nodes; a field is (name value...)
///     (is name outer)                                               IS in a node of a PROTO's body
///     (proto NAME ((access type name value...)...) statement...)    (externproto NAME ((access type name)...) url...)
///     (route NODE event NODE event)
///
/// Strings stand in double quotes without escapes. Brackets must match.
namespace gs::vrml::test {

/// Atom, or list of forms.
struct Form {
  SourceName atom;  // empty for a list; a string keeps its first quote
  std::vector<Form> list;

  [[nodiscard]] bool is_list() const { return atom.text.empty(); }
  [[nodiscard]] SourceName head() const { return list.empty() ? SourceName{} : list.front().atom; }
};

class FormReader {
 public:
  explicit FormReader(std::string_view text) : text_(text) {}

  /// Reads forms up to the closing bracket or the end of the text.
  std::vector<Form> read() {
    std::vector<Form> forms;
    while (at_ < text_.size()) {
      const SourceLocation location{line_, column_};
      const char c = text_[at_];
      if (c == '(' || c == ')') advance();
      if (c == ')') return forms;
      if (c == '(') {
        forms.push_back({{{}, location}, read()});
      } else if (std::isspace(static_cast<unsigned char>(c))) {
        advance();
      } else {
        forms.push_back({{read_atom(c == '"'), location}, {}});
      }
    }
    return forms;
  }

 private:
  void advance() {
    column_ = text_[at_] == '\n' ? 1 : column_ + 1;
    line_ += text_[at_++] == '\n' ? 1 : 0;
  }
  std::string_view read_atom(bool string) {
    const std::size_t begin = at_;
    const std::size_t end = std::min(text_.size(), text_.find_first_of(string ? "\"" : " \n()", begin + 1));
    while (at_ < end) advance();
    if (string && at_ < text_.size()) advance();
    return text_.substr(begin, end - begin);
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::uint32_t line_ = 1, column_ = 1;
};

class SceneReader {
 public:
  SceneReader(SceneGraph& scene, Diagnostics& diagnostics) : sink_(scene, diagnostics) {}

  void read(std::string_view text) {
    for (const Form& form : FormReader(text).read()) read_statement(form, 1);
    sink_.finish();
  }

 private:
  using Forms = std::vector<Form>;

  void read_statement(const Form& form, std::size_t depth) {
    const std::string_view head = form.head().text;
    if (head == "proto" || head == "externproto") return read_prototype(form.list, head == "externproto", depth);
    if (head != "route") return read_node(form, {}, depth);
    const auto name = [&](std::size_t i) { return std::string(form.list.at(i).atom.text); };
    sink_.routes().add({name(1), name(2), name(3), name(4), form.head().location});
  }

  void read_node(const Form& form, NodeTarget target, std::size_t depth) {
    if (form.head().text == "use") return sink_.use_node(form.list.at(1).atom, target);
    const bool named = form.head().text == "def";
    const Form& body = named ? form.list.at(2) : form;
    OpenNode node =
        sink_.begin_node({body.head(), named ? form.list.at(1).atom.text : std::string_view{}, target, depth});
    if (!node.id) return;
    for (std::size_t i = 1; i < body.list.size(); ++i) read_field(node, body.list[i].list, depth + 1);
    sink_.end_node(node.id);
  }

  void read_field(OpenNode& node, const Forms& forms, std::size_t depth) {
    const SourceName name = forms.at(0).atom;
    if (name.text == "is") return sink_.prototypes().connect(node, forms.at(1).atom, forms.at(2).atom);
    if (node.own_type && access_named(name.text)) return read_declaration(*node.own_type, node.id, forms, depth);
    const InterfaceDeclaration* const field = sink_.find_field(node, name);
    if (!field) return;
    read_value(field->type, sink_.target_of(node, *field), forms, 1, depth);
    sink_.field_given(node, *field, name);
  }

  void read_prototype(const Forms& forms, bool external, std::size_t depth) {
    NodeType& type = sink_.prototypes().begin_prototype(forms.at(1).atom, external);
    for (const Form& declaration : forms.at(2).list) read_declaration(type, {}, declaration.list, depth);
    sink_.prototypes().end_interface();
    if (external) {
      FieldValue url = MFString{};
      read_value(FieldType::MFString, {&url, {}}, forms, 3, depth);
      return sink_.prototypes().end_external(type, std::get<MFString>(url));
    }
    sink_.prototypes().begin_body(type);
    for (std::size_t i = 3; i < forms.size(); ++i) read_statement(forms[i], depth + 1);
    sink_.prototypes().end_body();
  }

  void read_declaration(NodeType& type, NodeId script, const Forms& forms, std::size_t depth) {
    InterfaceDeclaration declaration;
    declaration.access = access_named(forms.at(0).atom.text).value();
    declaration.type = field_type_named(forms.at(1).atom.text).value();
    declaration.name = forms.at(2).atom.text;
    if (declaration.access == AccessType::field || declaration.access == AccessType::exposedField) {
      declaration.initial = initial_value(declaration.type);
      read_value(declaration.type, {&declaration.initial, {}}, forms, 3, depth);
    }
    if (sink_.prototypes().may_declare(type, declaration, forms[2].atom.location))
      sink_.prototypes().declare(type, script, std::move(declaration));
  }

  void read_value(FieldType type, NodeTarget target, const Forms& forms, std::size_t first, std::size_t depth) {
    *target.value = initial_value(type);
    for (std::size_t i = first; i < forms.size(); ++i) {
      if (forms[i].is_list()) {
        read_node(forms[i], target, depth);
      } else if (auto* strings = std::get_if<MFString>(target.value)) {
        strings->push_back(string_of(forms[i]));
      } else if (auto* string = std::get_if<SFString>(target.value)) {
        *string = string_of(forms[i]);
      } else if (auto* vectors = std::get_if<MFVec3f>(target.value)) {
        vectors->push_back({number_of(forms, i), number_of(forms, i + 1), number_of(forms, i + 2)});
        i += 2;
      } else if (auto* floats = std::get_if<MFFloat>(target.value)) {
        floats->push_back(number_of(forms, i));
      } else if (auto* vector = std::get_if<SFVec3f>(target.value)) {
        (*vector)[static_cast<int>(i - first)] = number_of(forms, i);
      } else if (auto* color = std::get_if<SFColor>(target.value)) {
        *color = {number_of(forms, first), number_of(forms, first + 1), number_of(forms, first + 2)};
      } else if (auto* real = std::get_if<SFFloat>(target.value)) {
        *real = number_of(forms, i);
      } else {
        std::get<SFBool>(*target.value) = forms[i].atom.text == "TRUE";
      }
    }
    std::size_t charged = 0;
    if (is_multiple(type) && !holds_nodes(type)) sink_.limits().charge_growth(*target.value, charged, true);
  }

  String string_of(const Form& form) {
    const std::string_view text = form.atom.text.substr(1);
    return sink_.limits().admits_string(text.size(), form.atom.location) ? String(std::string(text)) : String();
  }

  static float number_of(const Forms& forms, std::size_t i) {
    float number = 0;
    (void)parse_number(forms.at(i).atom.text, number);
    return number;
  }

  static std::optional<AccessType> access_named(std::string_view word) {
    for (const AccessType access :
         {AccessType::eventIn, AccessType::eventOut, AccessType::field, AccessType::exposedField})
      if (word == name_of(access)) return access;
    return std::nullopt;
  }

  SceneSink sink_;
};

}  // namespace gs::vrml::test
