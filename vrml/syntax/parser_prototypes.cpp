#include "vrml/scene/prototype.h"
#include "vrml/syntax/parser_state.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

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
  auto type = std::make_unique<NodeType>();
  type->name = name.text;
  type->location = name.location;
  type->kind = external ? NodeType::Kind::external_prototype : NodeType::Kind::prototype;
  if (!external) {
    type->prototype = std::make_unique<Prototype>();
    type->prototype->scene = &scene;
    type->prototype->text = &source;
  }
  Frame frame;
  frame.kind = Frame::Kind::prototype_interface;
  frame.start = name.location;
  (void)scene.charge(sizeof(NodeType) + sizeof(Prototype));
  frame.declaring = &source.add_type(std::move(type));
  ++interfaces_open;
  if (!open(std::move(frame))) --interfaces_open;
  return Step::done;
}

void Parser::State::finish_pending() {
  Frame& frame = frames.back();
  if (!frame.pending) return;
  (void)scene.charge(sizeof(InterfaceDeclaration));
  if (frame.kind == Frame::Kind::node_body) {
    scene.declare(frame.node, *frame.declaring, std::move(*frame.pending));
  } else {
    frame.declaring->declare(std::move(*frame.pending));
  }
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
      error(token.location, "expected eventIn, eventOut, field, exposedField or ']', found " + describe(token));
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
      --interfaces_open;
      frames.pop_back();
      return Step::done;
    }
  }
  --interfaces_open;
  frames.pop_back();
  Frame frame;
  frame.start = start;
  frame.declaring = &type;
  if (external) {
    frame.kind = Frame::Kind::external_url;
    open(std::move(frame));
  } else {
    frame.kind = Frame::Kind::prototype_body;
    if (open(std::move(frame))) {
      scopes.emplace_back();
      scopes.back().prototype = &type;
    }
  }
  return Step::done;
}

Step Parser::State::external_url_step() {
  Frame& frame = frames.back();
  if (frame.into) {  // the url list is complete
    NodeType& type = *frame.declaring;
    type.url = std::get<MFString>(frame.pending->initial);
    frames.pop_back();
    add_type(type);
    return Step::done;
  }
  auto pending = std::make_unique<InterfaceDeclaration>();
  pending->initial = MFString{};
  FieldValue& url = pending->initial;
  // Set only after the value has begun, so that need_more leaves no trace.
  const std::size_t index = frames.size() - 1;
  const Step step = value(FieldType::MFString, url, "the url of EXTERNPROTO");
  if (step == Step::need_more) return step;
  frames[index].into = &url;
  frames[index].pending = std::move(pending);
  return Step::done;
}

// Ends the top scope, of a PROTO body or of the file, and closes the frame of a body.
void Parser::State::end_scope() {
  const std::vector<Scope::UnresolvedRoute> routes = std::exchange(scopes.back().unresolved_routes, {});
  for (const Scope::UnresolvedRoute& route : routes) add_route(route, true);
  NodeType* type = scopes.back().prototype;
  if (!type) return;
  scopes.pop_back();
  type->prototype->complete = true;
  count_instance_nodes(scene, *type->prototype);
  // The first node of the body determines where instances may stand (VRML97 4.8.3).
  for (const Statement& statement : type->prototype->statements) {
    if (statement.kind != Statement::Kind::node) continue;
    type->role = scene.node(statement.node).type->role;
    break;
  }
  frames.pop_back();
  add_type(*type);
}

// Adds a complete declaration: from here on, nodes of its name have this type. Names of types must be unique (4.8),
// except that extensions may have fallbacks with their names for other browsers.
void Parser::State::add_type(NodeType& type) {
  const NodeType* built_in = built_in_node_type(type.name);
  const NodeType*& known = scopes.back().types[type.name];
  const bool taken = known || (built_in && !is_extension(built_in->clause));
  if (taken && said_types.insert(type.name).second)
    warn(type.location,
         (known ? "a second declaration of '" + type.name + '\'' : '\'' + type.name + "' is a built-in node") +
             " (VRML97 4.8); this PROTO is used from here on");
  known = &type;
  add_type_statement(type);
}

// Adds the statement of a PROTO. If it is declared inside a node (Annex A.1), it is printed before that node.
void Parser::State::add_type_statement(const NodeType& type) {
  std::vector<Statement>& list =
      scopes.back().prototype ? scopes.back().prototype->prototype->statements : source.statements();
  auto place = list.end();
  const Frame::Kind inside = frames.back().kind;
  if (inside != Frame::Kind::statements && inside != Frame::Kind::prototype_body)
    while (place != list.begin() && (--place)->kind != Statement::Kind::node) {
    }
  list.insert(place, {Statement::Kind::prototype, {}, &type, {}});
}

}  // namespace gs::vrml
