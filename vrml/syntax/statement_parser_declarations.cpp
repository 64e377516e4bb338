#include "vrml/syntax/numbers/number.h"
#include "vrml/syntax/statement_parser.h"

#include <memory>
#include <string>
#include <utility>

// Parsing of statements that declare: PROTO and EXTERNPROTO with their interfaces, and the statements that X3D adds
// (ISO/IEC 19776-2 4.2): PROFILE, COMPONENT, META, UNIT, IMPORT and EXPORT.
namespace gs::vrml {

// Parses `protoStatement` or `externprotoStatement` of Annex A.1, up to the opening bracket of the interface.
Step StatementParser::prototype_head(bool external) {
  const Lexer::Position before = text_.lexer.position();
  const Token name = text_.lexer.next();
  if (name.kind == TokenKind::need_more) return Step::need_more;
  const Token bracket = name.kind == TokenKind::word ? text_.lexer.next() : name;
  if (bracket.kind == TokenKind::need_more) return Step::need_more;
  if (name.kind != TokenKind::word || bracket.kind != TokenKind::open_bracket) {
    text_.unexpected(name.kind != TokenKind::word ? name : bracket,
                     std::string("a name and '[' after ") + (external ? "EXTERNPROTO" : "PROTO"));
    text_.lexer.go_back(before);
    return Step::done;
  }
  text_.check_name(name);
  Frame frame;
  frame.kind = Frame::Kind::prototype_interface;
  frame.start = name.location;
  frame.declaring = &text_.sink.prototypes().begin_prototype(name_in(name), external);
  if (!text_.open(std::move(frame))) text_.sink.prototypes().end_interface();
  return Step::done;
}

// Parses the content of the brackets in PROTO name [ ... ] or EXTERNPROTO name [ ... ].
Step StatementParser::interface_step() {
  text_.finish_pending();
  NodeType& type = *text_.frames.back().declaring;
  const bool external = type.kind == NodeType::Kind::external_prototype;
  const Token token = text_.lexer.next();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (token.kind == TokenKind::end) return Step::finished;
  if (token.kind == TokenKind::word) {
    if (const auto access = access_named(token.text, text_.language())) {
      text_.rubbish = false;
      return interface_declaration(*access, type, !external, false);
    }
  }
  if (token.kind != TokenKind::close_bracket) {
    if (!std::exchange(text_.rubbish, true))
      text_.problems.error(token.location,
                           (text_.language() == Language::x3d
                                ? "expected inputOnly, outputOnly, initializeOnly, inputOutput or ']', found "
                                : "expected eventIn, eventOut, field, exposedField or ']', found ") +
                               describe(token));
    return Step::done;
  }
  if (text_.table_text) return Step::finished;
  SourceLocation start = text_.frames.back().start;
  if (!external) {
    const Lexer::Position behind = text_.lexer.position();
    const Token brace = text_.lexer.next();
    if (brace.kind == TokenKind::need_more) return Step::need_more;
    if (brace.kind != TokenKind::open_brace) {
      text_.unexpected(brace, "'{' and the body of PROTO " + type.name);
      text_.lexer.go_back(behind);
      text_.sink.prototypes().end_interface();
      text_.frames.pop_back();
      return Step::done;
    }
  }
  text_.sink.prototypes().end_interface();
  text_.frames.pop_back();
  Frame frame;
  frame.start = start;
  frame.declaring = &type;
  if (external) {
    frame.kind = Frame::Kind::external_url;
    text_.open(std::move(frame));
  } else {
    frame.kind = Frame::Kind::prototype_body;
    if (text_.open(std::move(frame))) text_.sink.prototypes().begin_body(type);
  }
  return Step::done;
}

Step StatementParser::external_url_step() {
  Frame& frame = text_.frames.back();
  if (frame.into) {  // the list of URLs is complete
    text_.sink.prototypes().end_external(*frame.declaring, std::move(std::get<MFString>(frame.pending->initial)));
    text_.frames.pop_back();
    return Step::done;
  }
  auto pending = std::make_unique<InterfaceDeclaration>();
  pending->initial = MFString{};
  FieldValue& url = pending->initial;
  // Changes the frame only after the value has begun: on need_more, nothing may have changed.
  const std::size_t index = text_.frames.size() - 1;
  const Step step = value(FieldType::MFString, url, "the url of EXTERNPROTO", {});
  if (step == Step::need_more) return step;
  text_.frames[index].into = &url;
  text_.frames[index].pending = std::move(pending);
  return Step::done;
}

Step StatementParser::x3d_statement(const Token& keyword, bool& was_statement) {
  if (keyword.text == "COMPONENT") return component_statement(keyword);
  if (keyword.text == "META") return meta_statement(keyword);
  if (keyword.text == "UNIT") return unit_statement(keyword);
  if (keyword.text == "IMPORT") return import_statement(keyword);
  if (keyword.text == "EXPORT") return export_statement(keyword);
  was_statement = keyword.text == "PROFILE";
  if (!was_statement) return Step::done;
  const Lexer::Position before = text_.lexer.position();
  const Token name = text_.lexer.next();
  if (name.kind != TokenKind::word) return expected(keyword, name, before, "a profile");
  text_.sink.statements().set_profile(name_in(name));
  return Step::done;
}

// Reports an unusable token in a statement, and reads on with that token.
Step StatementParser::expected(const Token& keyword, const Token& found, const Lexer::Position& before,
                               std::string_view what) {
  if (found.kind == TokenKind::need_more) return Step::need_more;
  text_.unexpected(found, std::string(what) + " after " + std::string(keyword.text));
  text_.lexer.go_back(before);
  statement_failed_ = true;
  return Step::done;
}

// Parses `COMPONENT name:level`. There may be blanks around the colon.
Step StatementParser::component_statement(const Token& keyword) {
  const Lexer::Position before = text_.lexer.position();
  const Token first = text_.lexer.next();
  if (first.kind != TokenKind::word) return expected(keyword, first, before, "a component and its level");
  std::string text(first.text);
  for (;;) {
    const Lexer::Position behind = text_.lexer.position();
    const Token next = text_.lexer.next();
    if (next.kind == TokenKind::need_more) return Step::need_more;
    if (next.kind == TokenKind::word && (text.back() == ':' || next.text.front() == ':')) {
      text += next.text;
      continue;
    }
    text_.lexer.go_back(behind);
    break;
  }
  const std::size_t colon = text.find(':');
  std::int32_t level = 1;
  if (colon == std::string::npos || colon == 0 || !parse_number(std::string_view(text).substr(colon + 1), level))
    text_.problems.warn(first.location, "expected COMPONENT name:level, found " + quoted(text) + "; level 1 is used");
  text_.sink.statements().add_component({std::string_view(text).substr(0, colon), first.location}, level);
  return Step::done;
}

// Parses `META "name" "content"`.
Step StatementParser::meta_statement(const Token& keyword) {
  std::string texts[2];
  for (std::string& text : texts) {
    const Lexer::Position before = text_.lexer.position();
    const Token token = text_.lexer.next();
    if (token.kind != TokenKind::string) return expected(keyword, token, before, "two strings");
    bool latin1 = false;
    text = decode_string(token.text, token.has_escapes, latin1);
  }
  text_.sink.statements().add_meta(texts[0], texts[1], keyword.location);
  return Step::done;
}

// Parses `UNIT category name factor`.
Step StatementParser::unit_statement(const Token& keyword) {
  Token tokens[3];
  Lexer::Position before{};
  for (Token& token : tokens) {
    before = text_.lexer.position();
    token = text_.lexer.next();
    if (token.kind != TokenKind::word) return expected(keyword, token, before, "a category, a name and a factor");
  }
  double factor = 0;
  if (!parse_number(tokens[2].text, factor)) {
    return expected(keyword, tokens[2], before, "a category, a name and a factor");
  }
  text_.sink.statements().set_unit(name_in(tokens[0]), tokens[1].text, factor);
  return Step::done;
}

// Reads `AS name`, if it follows. Leaves `name` unchanged if it does not.
Step StatementParser::read_new_name(Token& name) {
  const Lexer::Position before = text_.lexer.position();
  const Token as = text_.lexer.next();
  if (as.kind == TokenKind::need_more) return Step::need_more;
  if (as.kind != TokenKind::word || as.text != "AS") {
    text_.lexer.go_back(before);
    return Step::done;
  }
  const Lexer::Position behind = text_.lexer.position();
  const Token token = text_.lexer.next();
  if (token.kind != TokenKind::word) return expected(as, token, behind, "a name");
  name = token;
  return Step::done;
}

// Parses `IMPORT inline.exported [AS name]`.
Step StatementParser::import_statement(const Token& keyword) {
  std::string inline_name, exported;
  Step step = Step::done;
  const bool good = read_node_event(inline_name, exported, step);
  if (step == Step::need_more) return step;
  if (!good) {
    text_.problems.error(keyword.location, "expected IMPORT inline.exportedName AS name");
    statement_failed_ = true;
    return Step::done;
  }
  Token name;
  step = read_new_name(name);
  if (step == Step::need_more) return step;
  if (name.kind == TokenKind::word) text_.check_name(name);
  text_.sink.statements().import_node({inline_name, keyword.location}, exported, name.text);
  return Step::done;
}

// Parses `EXPORT name [AS name]`.
Step StatementParser::export_statement(const Token& keyword) {
  const Lexer::Position before = text_.lexer.position();
  const Token local = text_.lexer.next();
  if (local.kind != TokenKind::word) return expected(keyword, local, before, "a name");
  Token name;
  const Step step = read_new_name(name);
  if (step == Step::need_more) return step;
  text_.sink.statements().export_node(name_in(local), name.text);
  return Step::done;
}

}  // namespace gs::vrml
