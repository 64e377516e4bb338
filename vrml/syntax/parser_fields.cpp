#include "vrml/syntax/parser_state.h"

#include <string>
#include <utility>

namespace gs::vrml {
namespace {

std::optional<AccessType> access_named(std::string_view word) {
  for (const AccessType access :
       {AccessType::eventIn, AccessType::eventOut, AccessType::field, AccessType::exposedField})
    if (word == name_of(access)) return access;
  return std::nullopt;
}

}  // namespace

// Parses `nodeBodyElement` of Annex A.1.
Step Parser::State::node_body_step() {
  finish_pending();
  const Token token = lexer.next();
  switch (token.kind) {
    case TokenKind::need_more:
      return Step::need_more;
    case TokenKind::end:
      return Step::finished;
    case TokenKind::close_brace:
      rubbish = false;
      end_node();
      return Step::done;
    case TokenKind::word:
      break;
    default:
      rubbish_token(token, "a field of " + frames.back().node.type->name + " or '}'");
      return Step::done;
  }
  bool was_statement = false;
  if (frames.back().declaring) {
    if (const auto access = access_named(token.text)) {
      const Step step = interface_declaration(*access, *frames.back().declaring, true, true);
      if (step == Step::done) rubbish = false;
      return step;
    }
  }
  Step step = statement(token, was_statement);
  if (!was_statement && step == Step::done) step = field(token);
  return step;
}

// Parses `fieldName value`, `fieldName IS name` or `eventName IS name`.
Step Parser::State::field(Token name) {
  const NodeType& type = *frames.back().node.type;
  // Names contain no point (Annex A.2), so a number may follow one directly.
  const std::string_view before_point = name.text.substr(0, name.text.find('.'));
  if (before_point.size() < name.text.size() && !type.find_field(name.text) && type.find_field(before_point)) {
    name.text = before_point;
    lexer.advance(before_point.data() + before_point.size(), 0, nullptr);
  }
  const char begins = lexer.peek();
  if (begins == 'I' || (begins == '\0' && !lexer.is_last_window())) {
    const Lexer::Position behind_name = lexer.position();
    const Token next = lexer.next();
    if (next.kind == TokenKind::need_more) return Step::need_more;
    if (next.kind == TokenKind::word && next.text == "IS") {
      const Step step = is_mapping(name);
      if (step == Step::done) rubbish = false;
      return step;
    }
    lexer.go_back(behind_name);
  }
  if (looks_like_number(name.text) && !type.find_field(name.text)) {
    if (!std::exchange(rubbish, true))
      problems.error(name.location, "expected a field of " + type.name + " or '}', found " + describe(name));
    return Step::done;
  }
  rubbish = false;
  const std::size_t index = frames.size() - 1;
  const InterfaceDeclaration* const declaration = sink.find_field(frames[index].node, name_in(name));
  if (!declaration) {
    skip_value();
    return Step::done;
  }
  const NodeTarget target = sink.target_of(frames[index].node, *declaration);
  const Step step = value(declaration->type, *target.value, declaration->name, target.field);
  if (step == Step::done) sink.field_given(frames[index].node, *declaration, name_in(name));
  return step;
}

// Parses the rest of `name IS outer` for the node on top, in a PROTO body (VRML97 4.8.2). IS has been read.
Step Parser::State::is_mapping(const Token& name) {
  const Token outer_name = lexer.next();
  if (outer_name.kind == TokenKind::need_more) return Step::need_more;
  if (outer_name.kind != TokenKind::word) {
    unexpected(outer_name, "a name after IS");
    return Step::done;
  }
  sink.connect(frames.back().node, name_in(name), name_in(outer_name));
  return Step::done;
}

// Parses `access type name [value]` after the access. `values` tells whether fields have values here, which EXTERNPROTO
// lacks. `is_allowed` is set for a Script: its fields may use IS.
Step Parser::State::interface_declaration(AccessType access, NodeType& type, bool values, bool is_allowed) {
  const Lexer::Position behind_access = lexer.position();
  const Token type_name = lexer.next();
  if (type_name.kind == TokenKind::need_more) return Step::need_more;
  const Token name = type_name.kind == TokenKind::word ? lexer.next() : type_name;
  if (name.kind == TokenKind::need_more) return Step::need_more;
  const auto field_type = field_type_named(type_name.text);
  if (!field_type || type_name.kind != TokenKind::word || name.kind != TokenKind::word) {
    unexpected(field_type ? name : type_name, "a field type and a name after " + std::string(name_of(access)));
    lexer.go_back(behind_access);
    if (type_name.kind == TokenKind::word) {
      (void)lexer.next();
      if (name.kind == TokenKind::word) (void)lexer.next();
      skip_value();
    }
    return Step::done;
  }
  const bool stored = access == AccessType::field || access == AccessType::exposedField;
  check_reserved(name);
  auto pending = std::make_unique<InterfaceDeclaration>();
  pending->access = access;
  pending->type = *field_type;
  pending->name = name.text;
  if (stored) pending->initial = initial_value(*field_type);

  bool is = false;
  if (is_allowed) {
    const Lexer::Position behind_name = lexer.position();
    const Token next = lexer.next();
    if (next.kind == TokenKind::need_more) return Step::need_more;
    is = next.kind == TokenKind::word && next.text == "IS";
    if (!is) {
      lexer.go_back(behind_name);
    } else {
      const Lexer::Position behind_is = lexer.position();
      if (lexer.next().kind == TokenKind::need_more) return Step::need_more;
      lexer.go_back(behind_is);
    }
  }
  const std::size_t index = frames.size() - 1;
  if (stored && values && !is) {
    const Step step = value(*field_type, pending->initial, pending->name, {});
    if (step == Step::need_more) return step;
  }
  if (!sink.may_declare(type, *pending, name.location)) {
    kept_values.push_back(std::move(pending));  // its value may still be arriving
    return Step::done;
  }
  frames[index].pending = std::move(pending);
  if (is) {
    finish_pending();
    return is_mapping(name);
  }
  if (stored && !values) {
    // Some EXTERNPROTOs repeat the values of the PROTO; skip them.
    skip_interface_value();
  }
  return Step::done;
}

// Skips a value in an EXTERNPROTO declaration, where values are not allowed.
void Parser::State::skip_interface_value() {
  finish_pending();
  skip_value();
  frames.back().value_unexpected = true;
}

void Parser::State::skip_value() {
  Frame frame;
  frame.kind = Frame::Kind::skip;
  frame.start = lexer.location();
  frames.push_back(std::move(frame));
}

// Skips a value of unknown type (consecutive numbers and strings, one word, a list, or a node) or the rest of an open
// construct.
Step Parser::State::skip_step() {
  const Lexer::Position before = lexer.position();
  const Token token = lexer.next();
  Frame& frame = frames.back();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (token.kind == TokenKind::end) {
    if (frame.depth > 0) return Step::finished;
    frames.pop_back();
    return Step::done;
  }
  const auto leave = [&] {
    lexer.go_back(before);
    frames.pop_back();
    return Step::done;
  };
  const auto complain = [&] {
    if (frame.value_unexpected && !std::exchange(said_external_value, true))
      problems.warn(token.location, "an EXTERNPROTO declares no values; skipped");
  };
  switch (token.kind) {
    case TokenKind::open_brace:
    case TokenKind::open_bracket:
      if (frame.depth == 0 && frame.skipped_value) return leave();
      complain();
      ++frame.depth;
      return Step::done;
    case TokenKind::close_brace:
    case TokenKind::close_bracket:
      if (frame.depth == 0) return leave();
      if (--frame.depth == 0) frames.pop_back();
      return Step::done;
    case TokenKind::string:
      complain();
      frame.skipped_value = true;
      return Step::done;
    case TokenKind::unterminated_string:
      unexpected(token, "'\"'");
      return Step::done;
    case TokenKind::bad:
      return Step::done;
    default:
      break;
  }
  if (token.text == "DEF") {
    if (frame.depth == 0 && frame.skipped_value) return leave();
    // A named node is read nevertheless, since a later USE may refer to it.
    discarded = MFNode{};
    const bool whole_value = frame.depth == 0;
    const std::size_t index = frames.size() - 1;
    const Step step = node_head(token, {&discarded, {}});
    if (step == Step::done && whole_value) frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(index));
    return step;
  }
  if (frame.depth > 0) return Step::done;
  if (looks_like_number(token.text)) {
    complain();
    frame.skipped_value = true;
    return Step::done;
  }
  if (frame.skipped_value) return leave();
  if (token.text == "TRUE" || token.text == "FALSE" || token.text == "NULL") {
    complain();
    frames.pop_back();
    return Step::done;
  }
  if (token.text == "USE" || token.text == "IS") {
    const Token name = lexer.next();
    if (name.kind == TokenKind::need_more) return Step::need_more;
    frames.pop_back();
    return Step::done;
  }
  const Token brace = lexer.next();
  if (brace.kind == TokenKind::need_more) return Step::need_more;
  if (brace.kind != TokenKind::open_brace) return leave();
  frame.depth = 1;
  return Step::done;
}

}  // namespace gs::vrml
