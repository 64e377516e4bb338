#include "vrml/scene/prototype.h"
#include "vrml/syntax/parser_state.h"
#include "vrml/syntax/stand_ins.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace gs::vrml {

// Parses `statement` of Annex A.1, inside a file or a PROTO body.
Step Parser::State::statement_step() {
  const bool in_body = frames.back().kind == Frame::Kind::prototype_body;
  const Token token = lexer.next();
  if (token.kind == TokenKind::need_more) return Step::need_more;
  if (token.kind == TokenKind::end) return Step::finished;
  if (token.kind == TokenKind::close_brace && in_body) {
    end_scope();
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
      if (headerless && !anything_read && token.text != "DEF" && !find_type(token.text)) {
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
      const Step node = node_head(token, nullptr);
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
    if (keyword.text == other && !find_type(other)) return other_statement(keyword);
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
    error(keyword.location, describe(keyword) + " is not a VRML97 statement; skipped");
    return Step::done;
  }
}

const NodeType* Parser::State::find_type(std::string_view name) const {
  for (auto scope = scopes.rbegin(); scope != scopes.rend(); ++scope) {
    const auto found = scope->types.find(name);
    if (found == scope->types.end()) continue;
    const NodeType* native = stood_for(*found->second);
    return native ? native : found->second;
  }
  return built_in_node_type(name);
}

const NodeType* Parser::State::find_stand_in(const Token& name) {
  const auto known = stand_ins.find(name.text);
  if (known != stand_ins.end()) return known->second;
  const NodeType* type = stand_in(scene, name.text);
  if (!type) return nullptr;
  stand_ins.emplace(type->name, type);
  warn(name.location,
       describe(name) + " is not a VRML97 node, but an extension of other browsers; a stand-in replaces it");
  return type;
}

// Parses `nodeStatement` of Annex A.1. `token`, already read, is DEF, USE or a type name. A null `into` means that the
// node is a statement of its own.
Step Parser::State::node_head(Token token, FieldValue* into) {
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
      const NodeId* const found = scopes.back().names.find(id.text);
      if (!found) {
        error(id.location, "USE of " + describe(id) + ", but no earlier DEF has this name");
      } else if (*found) {
        place(*found, into);
      }
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
      if (token.kind != TokenKind::open_brace || !find_type(id.text)) return Step::done;
      // The name is missing; this token is the type.
      token = id;
      name = {};
    }
  }
  const Lexer::Position behind_type = lexer.position();
  const Token brace = lexer.next();
  if (brace.kind == TokenKind::need_more) return Step::need_more;
  const NodeType* type = find_type(token.text);
  if (brace.kind != TokenKind::open_brace) {
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
  if (!type) type = find_stand_in(token);
  if (!type) {
    // Reports each type once, as far as types can be remembered.
    constexpr std::size_t kMostTypes = 1000;
    const bool known = unknown_types.contains(std::string(token.text));
    if (!known) error(token.location, "unknown node type " + describe(token) + "; the node is skipped");
    if (!known && unknown_types.size() < kMostTypes) unknown_types.emplace(token.text);
    if (!name.empty() && !scopes.back().names.find(name))
      if (const std::string* const kept = scene.keep_name(name)) scopes.back().names.insert(*kept);
    frame.kind = Frame::Kind::skip;
    frame.depth = 1;
    frames.push_back(std::move(frame));
    return Step::done;
  }
  frame.kind = Frame::Kind::node_body;
  if (type->kind == NodeType::Kind::script) {
    // Each Script has its own interface, which its body extends.
    auto own = std::make_unique<NodeType>();
    own->name = type->name;
    own->clause = type->clause;
    own->kind = type->kind;
    own->role = type->role;
    own->behaviour = type->behaviour;
    own->url_content = type->url_content;
    (void)scene.charge(sizeof(NodeType) + type->interfaces.size() * sizeof(InterfaceDeclaration));
    for (const InterfaceDeclaration& declaration : type->interfaces) own->declare(declaration);
    frame.declaring = &source.add_type(std::move(own));
    type = frame.declaring;
  }
  const NodeId node = scene.create(*type, token.location);
  if (!node) {
    if (!scene.exhausted() && !std::exchange(said_limit, true))
      error(token.location, "more than " + std::to_string(scene.limits().nodes) + " nodes; the rest is left out");
    frame.kind = Frame::Kind::skip;
    frame.depth = 1;
    frames.push_back(std::move(frame));
    return Step::done;
  }
  if (in_prototype_body()) {
    scene.put_in_body(node, *scopes.back().prototype->prototype);
  }
  if (!name.empty()) {
    scene.set_name(node, name);
    scopes.back().names.insert(scene.node(node).name) = node;
  }
  frame.node = node;
  frame.type = type;
  place(node, into);
  open(std::move(frame));
  return Step::done;
}

void Parser::State::place(NodeId node, FieldValue* into) {
  (void)scene.charge(into ? sizeof(NodeId) : sizeof(Statement));
  if (into) {
    if (auto* list = std::get_if<MFNode>(into)) {
      list->push_back(node);
    } else {
      *std::get_if<SFNode>(into) = node;
    }
  } else if (scopes.back().prototype) {
    scopes.back().prototype->prototype->statements.push_back({Statement::Kind::node, node, nullptr, {}});
  } else {
    source.add_root(node);
  }
}

// Completes the node on top of the stack.
void Parser::State::end_node() {
  const NodeId node = frames.back().node;
  frames.pop_back();
  check_measures(node);
  if (!scene.node(node).type->prototype) return;
  const auto before = static_cast<std::uint32_t>(scene.node_count());
  if (!instantiate(scene, node) && !scene.budget()->stopped() && !std::exchange(said_limit, true))
    error(scene.node(node).location,
          why_not_expanded(scene, *scene.node(node).type) + "; the missing parts stay empty");
  for (std::uint32_t i = before + 1; i <= scene.node_count(); ++i) check_measures(scene.id_at(i));
}

// Checks that the measures of a geometry are above 0 (VRML97 6.7, 6.11, 6.14, 6.17, 6.43). Nodes of a PROTO's body are
// checked per instance and reported once.
void Parser::State::check_measures(NodeId id) {
  const Node& node = scene.node(id);
  if (node.type->measures.empty() || node.in_prototype_body) return;
  for (const int slot : node.type->measures) {
    const auto* number = std::get_if<SFFloat>(&node.values[slot]);
    const auto* vector = std::get_if<SFVec3f>(&node.values[slot]);
    const std::vector<float> measures = number ? std::vector{*number} : std::vector{vector->x, vector->y, vector->z};
    if (std::all_of(measures.begin(), measures.end(), [](float m) { return m > 0 && std::isfinite(m); })) continue;
    if (!said_measures.insert(std::uint64_t{node.location.line} << 32 | node.location.column).second) return;
    const bool flat = std::all_of(measures.begin(), measures.end(), [](float m) { return m >= 0 && std::isfinite(m); });
    const auto declared = std::find_if(node.type->interfaces.begin(), node.type->interfaces.end(),
                                       [&](const InterfaceDeclaration& field) { return field.slot == slot; });
    report(flat ? Severity::warning : Severity::error, node.location,
           node.type->name + '.' + declared->name + ": expected sizes above 0; " + (flat ? "drawn flat" : "not drawn"));
    return;
  }
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
  Scope::UnresolvedRoute route;
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
    error(location, "expected ROUTE node.eventOut TO node.eventIn");
    return Step::done;
  }
  add_route(route, false);
  return Step::done;
}

// Adds a ROUTE. Its nodes should be DEFed before it; otherwise the ROUTE waits until the scope ends.
void Parser::State::add_route(const Scope::UnresolvedRoute& wanted, bool last_chance) {
  Scope& scope = scopes.back();
  const NodeId* const from = scope.names.find(wanted.from);
  const NodeId* const to = scope.names.find(wanted.to);
  if (!from || !to) {
    if (!last_chance) {
      constexpr std::size_t kNames = 64;
      (void)scene.charge(sizeof wanted + kNames);
      scope.unresolved_routes.push_back(wanted);
    } else {
      error(wanted.location, "ROUTE names '" + (!from ? wanted.from : wanted.to) + "', but no DEF has this name");
    }
    return;
  }
  if (!*from || !*to) return;  // a skipped node, already reported
  Route route{*from, *to, nullptr, nullptr};
  const NodeType& from_type = *scene.node(route.from).type;
  const NodeType& to_type = *scene.node(route.to).type;
  route.event_out = from_type.find_event_out(wanted.event_out);
  route.event_in = to_type.find_event_in(wanted.event_in);
  if ((!route.event_out && from_type.stands_in) || (!route.event_in && to_type.stands_in)) return;
  if (!route.event_out) {
    error(wanted.location, from_type.name + " has no eventOut '" + wanted.event_out + "'");
    return;
  }
  if (!route.event_in) {
    error(wanted.location, to_type.name + " has no eventIn '" + wanted.event_in + "'");
    return;
  }
  if (route.event_out->type != route.event_in->type) {
    error(wanted.location, "ROUTE from " + std::string(name_of(route.event_out->type)) + " '" + wanted.event_out +
                               "' to " + std::string(name_of(route.event_in->type)) + " '" + wanted.event_in +
                               "'; expected equal types");
    return;
  }
  std::vector<Statement>& statements = scope.prototype ? scope.prototype->prototype->statements : source.statements();
  (void)scene.charge(sizeof(Statement) + sizeof(Route));
  statements.push_back({Statement::Kind::route, {}, nullptr, route});
  if (!scope.prototype) scene.routes().push_back(route);
}

void Parser::State::check_name(const Token& name) {
  if (!is_id(name.text))
    warn_once(said_bad_id, name.location, describe(name) + " is not a legal name (VRML97 Annex A.2); accepted");
  check_reserved(name);
}

void Parser::State::check_reserved(const Token& name) {
  const int word = reserved_word(name.text);
  if (word < 0 || (said_reserved >> word & 1)) return;
  said_reserved |= std::uint32_t{1} << word;
  warn(name.location, describe(name) + " is a reserved word (VRML97 4.3.1); accepted as a name");
}

}  // namespace gs::vrml
