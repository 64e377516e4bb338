#include "vrml/syntax/parser_state.h"

#include <string>
#include <utility>

namespace gs::vrml {

// Parses `statement` of Annex A.1, inside a file or a PROTO body.
Step Parser::State::statement_step() {
  const bool in_body = frames.back().kind == Frame::Kind::prototype_body;
  const Token token = lexer.next();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (token.kind == TokenKind::end) return Step::finished;
  if (token.kind == TokenKind::close_brace && in_body) {
    end_body();
    return Step::done;
  }
  if (token.kind == TokenKind::word) {
    bool was_statement = false;
    const Step step = statement(token, was_statement);
    if (was_statement || step != Step::done) {
      if (step == Step::done) anything_read = true, rubbish = false;
      return step;
    }
    // A node, if an opening brace or a node keyword follows.
    if (token.text == "DEF" || token.text == "USE" || is_id(token.text)) {
      if (headerless && !anything_read && token.text != "DEF" && !sink.find_type(token.text)) {
        const Lexer::Position behind = lexer.position();
        const Token brace = lexer.next();
        if (brace.kind == TokenKind::need_more) return Step::need_more;
        lexer.go_back(behind);
        if (brace.kind != TokenKind::open_brace) {
          refuse("not VRML97: expected '#VRML V2.0 utf8' on the first line, or a node; found " + describe(token),
                 token.location);
          return Step::finished;
        }
      }
      const Step node = node_head(token, {});
      if (node == Step::done) anything_read = true;
      return node;
    }
  }
  if (headerless && !anything_read) {
    refuse("not VRML97: expected '#VRML V2.0 utf8' on the first line, or a node; found " + describe(token),
           token.location);
    return Step::finished;
  }
  rubbish_token(token, "a node, PROTO, EXTERNPROTO or ROUTE");
  return Step::done;
}

// Parses PROTO, EXTERNPROTO and ROUTE, which may stand wherever a statement or a field may.
Step Parser::State::statement(const Token& keyword, bool& was_statement) {
  was_statement = true;
  if (keyword.text == "ROUTE") return route_statement(keyword.location);
  if (keyword.text == "PROTO") return prototype_head(false);
  if (keyword.text == "EXTERNPROTO") return prototype_head(true);
  for (const std::string_view other : {"META", "PROFILE", "COMPONENT", "UNIT", "IMPORT", "EXPORT"})
    if (keyword.text == other && !sink.find_type(other)) return other_statement(keyword);
  was_statement = false;
  return Step::done;
}

// Skips to the end of the line: a statement of X3D or of an old browser, which some files with a VRML97 header contain.
Step Parser::State::other_statement(const Token& keyword) {
  for (;;) {
    const Lexer::Position before = lexer.position();
    const Token token = lexer.next();
    if (token.kind == TokenKind::need_more) return Step::need_more;
    const bool belongs = token.location.line == keyword.location.line &&
                         (token.kind == TokenKind::word || token.kind == TokenKind::string);
    if (belongs) continue;
    lexer.go_back(before);
    problems.error(keyword.location, describe(keyword) + " is not a VRML97 statement; skipped");
    return Step::done;
  }
}

// Parses `nodeStatement` of Annex A.1. `token`, already read, is DEF, USE or a type name.
Step Parser::State::node_head(Token token, NodeTarget target) {
  std::string_view name;
  if (token.text == "DEF" || token.text == "USE") {
    const bool define = token.text == "DEF";
    Lexer::Position before = lexer.position();
    const Token id = lexer.next();
    if (id.kind == TokenKind::need_more) return Step::need_more;
    if (id.kind != TokenKind::word) {
      unexpected(id, "a name after " + std::string(token.text));
      lexer.go_back(before);
      return Step::done;
    }
    check_name(id);
    if (!define) {
      sink.use_node(name_in(id), target);
      rubbish = false;
      return Step::done;
    }
    name = id.text;
    before = lexer.position();
    token = lexer.next();
    if (token.kind == TokenKind::need_more) return Step::need_more;
    if (token.kind != TokenKind::word) {
      unexpected(token, "a node type after DEF " + std::string(name));
      lexer.go_back(before);
      if (token.kind != TokenKind::open_brace || !sink.find_type(id.text)) return Step::done;
      // The name is missing; this token is the type.
      token = id;
      name = {};
    }
  }
  const Lexer::Position behind_type = lexer.position();
  const Token brace = lexer.next();
  if (brace.kind == TokenKind::need_more) return Step::need_more;
  if (brace.kind != TokenKind::open_brace) {
    const NodeType* const type = sink.find_type(token.text);
    // For prose instead of nodes, reports only the first word.
    if (brace.kind == TokenKind::end && (type || frames.size() > 1)) {
      unexpected(brace, "'{' after " + std::string(token.text));
    } else if (!std::exchange(rubbish, true)) {
      type ? unexpected(brace, "'{' after " + std::string(token.text)) : unexpected(token, "a node");
    }
    lexer.go_back(behind_type);
    return Step::done;
  }
  rubbish = false;
  Frame frame;
  frame.start = token.location;
  frame.node = sink.begin_node({name_in(token), name, target, frames.size()});
  frame.kind = frame.node.id ? Frame::Kind::node_body : Frame::Kind::skip;
  frame.declaring = frame.node.own_type;
  frame.depth = 1;
  frames.push_back(std::move(frame));
  return Step::done;
}

// Completes the node on top of the stack.
void Parser::State::end_node() {
  const NodeId node = frames.back().node.id;
  frames.pop_back();
  sink.end_node(node);
}

// Reads `node.event`, also with blanks around the point. The last point separates the two, so that illegal names with
// points work.
bool Parser::State::read_node_event(std::string& node, std::string& event, Step& step) {
  std::string text;
  step = Step::done;
  for (;;) {
    const Lexer::Position before = lexer.position();
    const Token token = lexer.next();
    if (token.kind == TokenKind::need_more) {
      step = Step::need_more;
      return false;
    }
    const bool goes_on =
        text.empty() || text.back() == '.' || (token.kind == TokenKind::word && token.text.front() == '.');
    if (token.kind != TokenKind::word || !goes_on) {
      lexer.go_back(before);
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

Step Parser::State::route_statement(SourceLocation location) {
  RouteNames route;
  route.location = location;
  Step step = Step::done;
  bool good = read_node_event(route.from, route.event_out, step);
  if (step == Step::need_more) return step;
  if (good) {
    const Lexer::Position before = lexer.position();
    const Token to = lexer.next();
    if (to.kind == TokenKind::need_more) return Step::need_more;
    good = to.kind == TokenKind::word && to.text == "TO";
    if (!good) lexer.go_back(before);
  }
  if (good) {
    good = read_node_event(route.to, route.event_in, step);
    if (step == Step::need_more) return step;
  }
  if (!good) {
    problems.error(location, "expected ROUTE node.eventOut TO node.eventIn");
    return Step::done;
  }
  sink.add_route(route);
  return Step::done;
}

void Parser::State::check_name(const Token& name) {
  if (!is_id(name.text))
    problems.warn_once(said_bad_id, name.location,
                       describe(name) + " is not a legal name (VRML97 Annex A.2); accepted");
  check_reserved(name);
}

void Parser::State::check_reserved(const Token& name) {
  const int word = reserved_word(name.text);
  if (word < 0 || (said_reserved >> word & 1)) return;
  said_reserved |= std::uint32_t{1} << word;
  problems.warn(name.location, describe(name) + " is a reserved word (VRML97 4.3.1); accepted as a name");
}

}  // namespace gs::vrml
