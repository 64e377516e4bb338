#include "vrml/syntax/statement_parser.h"

#include <string>
#include <utility>

namespace gs::vrml {

Step StatementParser::step() {
  switch (text_.frames.back().kind) {
    case Frame::Kind::statements:
    case Frame::Kind::prototype_body:
      return statement_step();
    case Frame::Kind::prototype_interface:
      return interface_step();
    case Frame::Kind::external_url:
      return external_url_step();
    case Frame::Kind::node_body:
      return node_body_step();
    case Frame::Kind::node_list:
      return node_list_step();
    case Frame::Kind::values:
      return values_.values_step();
    case Frame::Kind::image:
      return values_.image_step();
    case Frame::Kind::image_list:
      return values_.image_list_step();
    case Frame::Kind::skip:
      return skip_step();
  }
  return Step::finished;
}

// Parses `statement` of Annex A.1, inside a file or a PROTO body.
Step StatementParser::statement_step() {
  const bool in_body = text_.frames.back().kind == Frame::Kind::prototype_body;
  const Token token = text_.lexer.next();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (token.kind == TokenKind::end) return Step::finished;
  if (token.kind == TokenKind::close_brace && in_body) {
    text_.end_body();
    return Step::done;
  }
  if (token.kind == TokenKind::word) {
    bool was_statement = false;
    const Step step = statement(token, was_statement);
    if (was_statement || step != Step::done) {
      if (step == Step::done) text_.anything_read = true, text_.rubbish = std::exchange(statement_failed_, false);
      return step;
    }
    if (token.text == "NULL" && text_.anything_read && !text_.sink.find_type(token.text)) {
      text_.problems.warn_once(said_null_, token.location, "NULL is no statement; skipped");
      return Step::done;
    }
    // It is a node if an opening brace or a node keyword follows.
    if (token.text == "DEF" || token.text == "USE" || is_id(token.text)) {
      if (text_.headerless && !text_.anything_read && token.text != "DEF" && !text_.sink.find_type(token.text)) {
        const Lexer::Position behind = text_.lexer.position();
        const Token brace = text_.lexer.next();
        if (brace.kind == TokenKind::need_more) return Step::need_more;
        text_.lexer.go_back(behind);
        if (brace.kind != TokenKind::open_brace) {
          text_.refuse("not VRML97: expected '#VRML V2.0 utf8' on the first line, or a node; found " + describe(token),
                       token.location);
          return Step::finished;
        }
      }
      const Step node = node_head(token, {});
      if (node == Step::done) text_.anything_read = true;
      return node;
    }
  }
  if (text_.headerless && !text_.anything_read) {
    text_.refuse("not VRML97: expected '#VRML V2.0 utf8' on the first line, or a node; found " + describe(token),
                 token.location);
    return Step::finished;
  }
  text_.rubbish_token(token, "a node, PROTO, EXTERNPROTO or ROUTE");
  return Step::done;
}

// Parses a PROTO, EXTERNPROTO or ROUTE. They are allowed wherever a statement or a field is allowed.
Step StatementParser::statement(const Token& keyword, bool& was_statement) {
  was_statement = true;
  if (keyword.text == "ROUTE") return route_statement(keyword.location);
  if (keyword.text == "PROTO") return prototype_head(false);
  if (keyword.text == "EXTERNPROTO") return prototype_head(true);
  if (text_.language() == Language::x3d) return x3d_statement(keyword, was_statement);
  for (std::size_t i = 0; i < kOtherStatements.size(); ++i)
    if (keyword.text == kOtherStatements[i] && !text_.sink.find_type(keyword.text)) {
      const bool shares_nodes = keyword.text == "IMPORT" || keyword.text == "EXPORT";
      return shares_nodes ? sharing_statement(keyword, said_statements_[i])
                          : other_statement(keyword, said_statements_[i]);
    }
  was_statement = false;
  return Step::done;
}

// Parses IMPORT or EXPORT of X3D in a file with a VRML97 header. Reports each of them once.
Step StatementParser::sharing_statement(const Token& keyword, bool& said) {
  const Step step = keyword.text == "IMPORT" ? import_statement(keyword) : export_statement(keyword);
  if (step == Step::done)
    text_.problems.warn_once(said, keyword.location, describe(keyword) + " is a statement of X3D; read as in X3D");
  return step;
}

// Skips a statement of X3D or of an old browser up to the end of the line. Some files with a VRML97 header contain such
// statements. Reports each kind of statement once.
Step StatementParser::other_statement(const Token& keyword, bool& said) {
  for (;;) {
    const Lexer::Position before = text_.lexer.position();
    const Token token = text_.lexer.next();
    if (token.kind == TokenKind::need_more) return Step::need_more;
    const bool belongs = token.location.line == keyword.location.line &&
                         (token.kind == TokenKind::word || token.kind == TokenKind::string);
    if (belongs) continue;
    text_.lexer.go_back(before);
    text_.problems.warn_once(said, keyword.location, describe(keyword) + " is not a VRML97 statement; skipped");
    return Step::done;
  }
}

// Parses the start of `nodeStatement` of Annex A.1. `token` was read before: DEF, USE or a type name.
Step StatementParser::node_head(Token token, NodeTarget target) {
  std::string_view name;
  if (token.text == "DEF" || token.text == "USE") {
    const bool define = token.text == "DEF";
    Lexer::Position before = text_.lexer.position();
    const Token id = text_.lexer.next();
    if (id.kind == TokenKind::need_more) return Step::need_more;
    if (id.kind != TokenKind::word) {
      text_.unexpected(id, "a name after " + std::string(token.text));
      text_.lexer.go_back(before);
      return Step::done;
    }
    text_.check_name(id);
    if (!define) {
      text_.sink.use_node(name_in(id), target);
      text_.rubbish = false;
      return Step::done;
    }
    name = id.text;
    before = text_.lexer.position();
    token = text_.lexer.next();
    if (token.kind == TokenKind::need_more) return Step::need_more;
    if (token.kind != TokenKind::word) {
      text_.unexpected(token, "a node type after DEF " + std::string(name));
      text_.lexer.go_back(before);
      if (token.kind != TokenKind::open_brace || !text_.sink.find_type(id.text)) return Step::done;
      // The DEF name is missing; this token is the type name.
      token = id;
      name = {};
    }
  }
  const Lexer::Position behind_type = text_.lexer.position();
  const Token brace = text_.lexer.next();
  if (brace.kind == TokenKind::need_more) return Step::need_more;
  if (brace.kind != TokenKind::open_brace) {
    const NodeType* const type = text_.sink.find_type(token.text);
    // If the text is prose instead of nodes, reports only the first word.
    if (brace.kind == TokenKind::end && (type || text_.frames.size() > 1)) {
      text_.unexpected(brace, "'{' after " + std::string(token.text));
    } else if (!std::exchange(text_.rubbish, true)) {
      type ? text_.unexpected(brace, "'{' after " + std::string(token.text)) : text_.unexpected(token, "a node");
    }
    text_.lexer.go_back(behind_type);
    return Step::done;
  }
  text_.rubbish = false;
  Frame frame;
  frame.start = token.location;
  frame.node = text_.sink.begin_node({name_in(token), name, target, text_.frames.size()});
  frame.kind = frame.node.id ? Frame::Kind::node_body : Frame::Kind::skip;
  frame.declaring = frame.node.own_type;
  frame.depth = 1;
  text_.frames.push_back(std::move(frame));
  return Step::done;
}

Step StatementParser::node_list_step() {
  const Lexer::Position start = text_.lexer.position();
  const Token token = text_.lexer.next();
  switch (token.kind) {
    case TokenKind::need_more:
      return Step::need_more;
    case TokenKind::end:
      return Step::finished;
    case TokenKind::close_bracket:
      text_.rubbish = false;
      std::get_if<MFNode>(text_.frames.back().into)->shrink_to_fit();
      text_.frames.pop_back();
      return Step::done;
    case TokenKind::close_brace: {
      text_.problems.error(token.location, "expected ']' at the end of the list that begins at line " +
                                               std::to_string(text_.frames.back().start.line) + ", found '}'");
      text_.frames.pop_back();
      text_.lexer.go_back(start);
      return Step::done;
    }
    default:
      break;
  }
  if (token.kind == TokenKind::word && token.text == "NULL") return Step::done;
  bool was_statement = false;
  if (token.kind == TokenKind::word) {
    const Step read = statement(token, was_statement);
    if (was_statement) {
      if (read == Step::done)
        text_.problems.warn_once(said_route_in_list_, token.location,
                                 std::string(token.text) + " is not allowed in a list of nodes; moved before the node");
      return read;
    }
    if (is_id(token.text)) return node_head(token, {text_.frames.back().into, text_.frames.back().name});
  }
  text_.rubbish_token(token, "a node or ']'");
  return Step::done;
}

// Reads `node.event`. There may be blanks around the point. Splits at the last point, so that illegal names with points
// work.
bool StatementParser::read_node_event(std::string& node, std::string& event, Step& step) {
  std::string text;
  step = Step::done;
  for (;;) {
    const Lexer::Position before = text_.lexer.position();
    const Token token = text_.lexer.next();
    if (token.kind == TokenKind::need_more) {
      step = Step::need_more;
      return false;
    }
    const bool goes_on =
        text.empty() || text.back() == '.' || (token.kind == TokenKind::word && token.text.front() == '.');
    if (token.kind != TokenKind::word || !goes_on) {
      text_.lexer.go_back(before);
      break;
    }
    text += token.text;
  }
  const std::size_t point = text.rfind('.');
  if (point == std::string::npos || point == 0 || point + 1 == text.size()) return false;
  node = text.substr(0, point);
  event = text.substr(point + 1);
  return true;
}

Step StatementParser::route_statement(SourceLocation location) {
  RouteNames route;
  route.location = location;
  Step step = Step::done;
  bool good = read_node_event(route.from, route.event_out, step);
  if (step == Step::need_more) return step;
  if (good) {
    const Lexer::Position before = text_.lexer.position();
    const Token to = text_.lexer.next();
    if (to.kind == TokenKind::need_more) return Step::need_more;
    good = to.kind == TokenKind::word && to.text == "TO";
    if (!good) text_.lexer.go_back(before);
  }
  if (good) {
    good = read_node_event(route.to, route.event_in, step);
    if (step == Step::need_more) return step;
  }
  if (!good) {
    text_.problems.error(location, "expected ROUTE node.eventOut TO node.eventIn");
    return Step::done;
  }
  text_.sink.routes().add(route);
  return Step::done;
}

}  // namespace gs::vrml
