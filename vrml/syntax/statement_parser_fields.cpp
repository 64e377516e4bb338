#include "vrml/syntax/statement_parser.h"

#include <string>
#include <utility>

namespace gs::vrml {
// Parses `nodeBodyElement` of Annex A.1.
Step StatementParser::node_body_step() {
  text_.finish_pending();
  const Token token = text_.lexer.next();
  switch (token.kind) {
    case TokenKind::need_more:
      return Step::need_more;
    case TokenKind::end:
      return Step::finished;
    case TokenKind::close_brace:
      text_.rubbish = false;
      text_.end_node();
      return Step::done;
    case TokenKind::word:
      break;
    default:
      text_.rubbish_token(token, "a field of " + text_.frames.back().node.type->name + " or '}'");
      return Step::done;
  }
  bool was_statement = false;
  if (text_.frames.back().declaring) {
    if (const auto access = access_named(token.text, text_.language())) {
      const Step step = interface_declaration(*access, *text_.frames.back().declaring, true, true);
      if (step == Step::done) text_.rubbish = false;
      return step;
    }
  }
  Step step = statement(token, was_statement);
  if (!was_statement && step == Step::done) step = field(token);
  return step;
}

// Parses `fieldName value`, `fieldName IS name` or `eventName IS name`.
Step StatementParser::field(Token name) {
  const NodeType& type = *text_.frames.back().node.type;
  // Names contain no point (Annex A.2), so that a number with a point may follow directly after a name.
  const std::string_view before_point = name.text.substr(0, name.text.find('.'));
  if (before_point.size() < name.text.size() && !type.find_field(name.text) && type.find_field(before_point)) {
    name.text = before_point;
    text_.lexer.advance(before_point.data() + before_point.size(), 0, nullptr);
  }
  const char begins = text_.lexer.peek();
  if (begins == 'I' || (begins == '\0' && !text_.lexer.is_last_window())) {
    const Lexer::Position behind_name = text_.lexer.position();
    const Token next = text_.lexer.next();
    if (next.kind == TokenKind::need_more) return Step::need_more;
    if (next.kind == TokenKind::word && next.text == "IS") {
      const Step step = is_mapping(name);
      if (step == Step::done) text_.rubbish = false;
      return step;
    }
    text_.lexer.go_back(behind_name);
  }
  if (looks_like_number(name.text) && !type.find_field(name.text)) {
    if (!std::exchange(text_.rubbish, true))
      text_.problems.error(name.location, "expected a field of " + type.name + " or '}', found " + describe(name));
    return Step::done;
  }
  text_.rubbish = false;
  const std::size_t index = text_.frames.size() - 1;
  const InterfaceDeclaration* const declaration = text_.sink.find_field(text_.frames[index].node, name_in(name));
  if (!declaration) {
    text_.skip_value();
    return Step::done;
  }
  const NodeTarget target = text_.sink.target_of(text_.frames[index].node, *declaration);
  const Step step = value(declaration->type, *target.value, declaration->name, target.field);
  if (step == Step::done) text_.sink.field_given(text_.frames[index].node, *declaration, name_in(name));
  return step;
}

// Parses the value of a field. `name` is for diagnostics; `restricts` becomes NodeTarget::field. On need_more, reads
// nothing and does not change `into`.
Step StatementParser::value(FieldType type, FieldValue& into, std::string_view name, std::string_view restricts) {
  if (values_.plain_floats(type, into)) return Step::done;
  const Lexer::Position before = text_.lexer.position();
  const Token token = text_.lexer.next();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (type == FieldType::MFImage) return values_.image_list_head(into, token, before, name);
  if (token.kind == TokenKind::open_bracket && is_multiple(type)) {
    into = initial_value(type);
    values_.begin_list();
    Frame frame;
    frame.kind = type == FieldType::MFNode ? Frame::Kind::node_list : Frame::Kind::values;
    frame.start = token.location;
    frame.into = &into;
    frame.name = type == FieldType::MFNode ? restricts : name;
    text_.open(std::move(frame));
    return Step::done;
  }
  if (holds_nodes(type)) {
    if (token.kind == TokenKind::word && token.text == "NULL") {
      into = initial_value(type);
      return Step::done;
    }
    if (token.kind == TokenKind::word && !looks_like_number(token.text)) {
      FieldValue fresh = initial_value(type);
      FieldValue old = std::exchange(into, std::move(fresh));
      const Step step = node_head(token, {&into, restricts});
      if (step == Step::need_more) into = std::move(old);
      return step;
    }
    text_.unexpected(token, "a node for " + std::string(name));
    text_.lexer.go_back(before);
    text_.skip_value();
    return Step::done;
  }
  if (type == FieldType::SFImage) return values_.image_head(into, token, name);
  return values_.single_value(type, into, token, name);
}

// Parses the rest of `name IS outer`, after IS, for the node on top of the stack. It is in a PROTO body (VRML97 4.8.2).
Step StatementParser::is_mapping(const Token& name) {
  const Token outer_name = text_.lexer.next();
  if (outer_name.kind == TokenKind::need_more) return Step::need_more;
  if (outer_name.kind != TokenKind::word) {
    text_.unexpected(outer_name, "a name after IS");
    return Step::done;
  }
  text_.sink.prototypes().connect(text_.frames.back().node, name_in(name), name_in(outer_name));
  return Step::done;
}

// Parses `type name [value]` of an interface declaration, after the access type. `values` means that fields have values
// here, which EXTERNPROTO lacks. `is_allowed` is set for a Script: its fields may use IS.
Step StatementParser::interface_declaration(AccessType access, NodeType& type, bool values, bool is_allowed) {
  const Lexer::Position behind_access = text_.lexer.position();
  const Token type_name = text_.lexer.next();
  if (type_name.kind == TokenKind::need_more) return Step::need_more;
  const Token name = type_name.kind == TokenKind::word ? text_.lexer.next() : type_name;
  if (name.kind == TokenKind::need_more) return Step::need_more;
  const auto field_type = field_type_named(type_name.text);
  if (!field_type || type_name.kind != TokenKind::word || name.kind != TokenKind::word) {
    text_.unexpected(field_type ? name : type_name,
                     "a field type and a name after " + std::string(name_of(access, text_.language())));
    text_.lexer.go_back(behind_access);
    if (type_name.kind == TokenKind::word) {
      (void)text_.lexer.next();
      if (name.kind == TokenKind::word) (void)text_.lexer.next();
      text_.skip_value();
    }
    return Step::done;
  }
  const bool stored = access == AccessType::field || access == AccessType::exposedField;
  text_.check_reserved(name);
  auto pending = std::make_unique<InterfaceDeclaration>();
  pending->access = access;
  pending->type = *field_type;
  pending->name = name.text;
  if (stored) pending->initial = initial_value(*field_type);

  bool is = false;
  if (is_allowed) {
    const Lexer::Position behind_name = text_.lexer.position();
    const Token next = text_.lexer.next();
    if (next.kind == TokenKind::need_more) return Step::need_more;
    is = next.kind == TokenKind::word && next.text == "IS";
    if (!is) {
      text_.lexer.go_back(behind_name);
    } else {
      const Lexer::Position behind_is = text_.lexer.position();
      if (text_.lexer.next().kind == TokenKind::need_more) return Step::need_more;
      text_.lexer.go_back(behind_is);
    }
  }
  const std::size_t index = text_.frames.size() - 1;
  if (stored && values && !is) {
    const Step step = value(*field_type, pending->initial, pending->name, {});
    if (step == Step::need_more) return step;
  }
  if (!text_.sink.prototypes().may_declare(type, *pending, name.location)) {
    kept_values_.push_back(std::move(pending));  // keeps the value, because more of it may be received
    return is ? is_mapping(name) : Step::done;
  }
  text_.frames[index].pending = std::move(pending);
  if (is) {
    text_.finish_pending();
    return is_mapping(name);
  }
  if (stored && !values) {
    // Some EXTERNPROTOs repeat the values of the PROTO. Skips these values.
    skip_interface_value();
  }
  return Step::done;
}

// Skips the value in a declaration of an EXTERNPROTO, which must not have values.
void StatementParser::skip_interface_value() {
  text_.finish_pending();
  text_.skip_value();
  text_.frames.back().value_unexpected = true;
}

// Skips a value of unknown type, or the rest of an open construct. The value may be consecutive numbers and strings,
// one word, a list, or a node.
Step StatementParser::skip_step() {
  const Lexer::Position before = text_.lexer.position();
  const Token token = text_.lexer.next();
  Frame& frame = text_.frames.back();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (token.kind == TokenKind::end) {
    if (frame.depth > 0) return Step::finished;
    text_.frames.pop_back();
    return Step::done;
  }
  const auto leave = [&] {
    text_.lexer.go_back(before);
    text_.frames.pop_back();
    return Step::done;
  };
  const auto complain = [&] {
    if (frame.value_unexpected && !std::exchange(said_external_value_, true))
      text_.problems.warn(token.location, "interfaces of EXTERNPROTO take no values; skipped the value");
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
      if (--frame.depth == 0) text_.frames.pop_back();
      return Step::done;
    case TokenKind::string:
      complain();
      frame.skipped_value = true;
      return Step::done;
    case TokenKind::unterminated_string:
      text_.unexpected(token, "'\"'");
      return Step::done;
    case TokenKind::bad:
      return Step::done;
    default:
      break;
  }
  if (token.text == "DEF") {
    if (frame.depth == 0 && frame.skipped_value) return leave();
    // Reads a named node instead of skipping it, because a later USE may refer to it.
    discarded_ = MFNode{};
    const bool whole_value = frame.depth == 0;
    const std::size_t index = text_.frames.size() - 1;
    const Step step = node_head(token, {&discarded_, {}});
    if (step == Step::done && whole_value)
      text_.frames.erase(text_.frames.begin() + static_cast<std::ptrdiff_t>(index));
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
    text_.frames.pop_back();
    return Step::done;
  }
  if (token.text == "USE" || token.text == "IS") {
    const Token name = text_.lexer.next();
    if (name.kind == TokenKind::need_more) return Step::need_more;
    text_.frames.pop_back();
    return Step::done;
  }
  const Token brace = text_.lexer.next();
  if (brace.kind == TokenKind::need_more) return Step::need_more;
  if (brace.kind != TokenKind::open_brace) return leave();
  frame.depth = 1;
  return Step::done;
}

}  // namespace gs::vrml
