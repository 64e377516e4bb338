#include "vrml/syntax/statement_parser.h"

#include <memory>
#include <string>
#include <utility>

// Parsing of PROTO and EXTERNPROTO: their names, interfaces and bodies.
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
  frame.declaring = &text_.sink.begin_prototype(name_in(name), external);
  if (!text_.open(std::move(frame))) text_.sink.end_interface();
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
      text_.sink.end_interface();
      text_.frames.pop_back();
      return Step::done;
    }
  }
  text_.sink.end_interface();
  text_.frames.pop_back();
  Frame frame;
  frame.start = start;
  frame.declaring = &type;
  if (external) {
    frame.kind = Frame::Kind::external_url;
    text_.open(std::move(frame));
  } else {
    frame.kind = Frame::Kind::prototype_body;
    if (text_.open(std::move(frame))) text_.sink.begin_body(type);
  }
  return Step::done;
}

Step StatementParser::external_url_step() {
  Frame& frame = text_.frames.back();
  if (frame.into) {  // the list of URLs is complete
    text_.sink.end_external(*frame.declaring, std::move(std::get<MFString>(frame.pending->initial)));
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

}  // namespace gs::vrml
