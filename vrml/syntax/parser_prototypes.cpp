#include "vrml/syntax/parser_state.h"

#include <memory>
#include <string>
#include <utility>

// PROTO and EXTERNPROTO: their interfaces, bodies and names.
namespace gs::vrml {

// Parses `protoStatement` or `externprotoStatement` of Annex A.1, up to the opening bracket of the interface.
Step Parser::State::prototype_head(bool external) {
  const Lexer::Position before = lexer.position();
  const Token name = lexer.next();
  if (name.kind == TokenKind::need_more) return Step::need_more;
  const Token bracket = name.kind == TokenKind::word ? lexer.next() : name;
  if (bracket.kind == TokenKind::need_more) return Step::need_more;
  if (name.kind != TokenKind::word || bracket.kind != TokenKind::open_bracket) {
    unexpected(name.kind != TokenKind::word ? name : bracket,
               std::string("a name and '[' after ") + (external ? "EXTERNPROTO" : "PROTO"));
    lexer.go_back(before);
    return Step::done;
  }
  check_name(name);
  Frame frame;
  frame.kind = Frame::Kind::prototype_interface;
  frame.start = name.location;
  frame.declaring = &sink.begin_prototype(name_in(name), external);
  if (!open(std::move(frame))) sink.end_interface();
  return Step::done;
}

void Parser::State::finish_pending() {
  Frame& frame = frames.back();
  if (!frame.pending) return;
  sink.declare(*frame.declaring, frame.node.id, std::move(*frame.pending));
  frame.pending.reset();
}

// Parses the content of the brackets in PROTO name [ ... ] or EXTERNPROTO name [ ... ].
Step Parser::State::interface_step() {
  finish_pending();
  NodeType& type = *frames.back().declaring;
  const bool external = type.kind == NodeType::Kind::external_prototype;
  const Token token = lexer.next();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (token.kind == TokenKind::end) return Step::finished;
  if (token.kind == TokenKind::word) {
    for (const AccessType access :
         {AccessType::eventIn, AccessType::eventOut, AccessType::field, AccessType::exposedField})
      if (token.text == name_of(access)) {
        rubbish = false;
        return interface_declaration(access, type, !external, false);
      }
  }
  if (token.kind != TokenKind::close_bracket) {
    if (!std::exchange(rubbish, true))
      problems.error(token.location,
                     "expected eventIn, eventOut, field, exposedField or ']', found " + describe(token));
    return Step::done;
  }
  if (table_text) return Step::finished;
  SourceLocation start = frames.back().start;
  if (!external) {
    const Lexer::Position behind = lexer.position();
    const Token brace = lexer.next();
    if (brace.kind == TokenKind::need_more) return Step::need_more;
    if (brace.kind != TokenKind::open_brace) {
      unexpected(brace, "'{' and the body of PROTO " + type.name);
      lexer.go_back(behind);
      sink.end_interface();
      frames.pop_back();
      return Step::done;
    }
  }
  sink.end_interface();
  frames.pop_back();
  Frame frame;
  frame.start = start;
  frame.declaring = &type;
  if (external) {
    frame.kind = Frame::Kind::external_url;
    open(std::move(frame));
  } else {
    frame.kind = Frame::Kind::prototype_body;
    if (open(std::move(frame))) sink.begin_body(type);
  }
  return Step::done;
}

Step Parser::State::external_url_step() {
  Frame& frame = frames.back();
  if (frame.into) {  // the url list is complete
    sink.end_external(*frame.declaring, std::move(std::get<MFString>(frame.pending->initial)));
    frames.pop_back();
    return Step::done;
  }
  auto pending = std::make_unique<InterfaceDeclaration>();
  pending->initial = MFString{};
  FieldValue& url = pending->initial;
  // Set only after the value has begun, so that need_more leaves no trace.
  const std::size_t index = frames.size() - 1;
  const Step step = value(FieldType::MFString, url, "the url of EXTERNPROTO", {});
  if (step == Step::need_more) return step;
  frames[index].into = &url;
  frames[index].pending = std::move(pending);
  return Step::done;
}

void Parser::State::end_body() {
  frames.pop_back();
  sink.end_body();
}

}  // namespace gs::vrml
