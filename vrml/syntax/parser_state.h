#pragma once

#include "vrml/syntax/lexer.h"
#include "vrml/syntax/name_table.h"
#include "vrml/syntax/parser.h"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::vrml {

/// What one step of the parser came to.
enum class Step : std::uint8_t {
  done,            // something was read
  need_more,       // nothing was read: more bytes are needed first
  need_more_kept,  // likewise, but what was read before of this list counts
  finished,        // there is no more to read
};

/// One open construct. The stack of these is the parser's whole memory of where it is.
struct Frame {
  enum class Kind : std::uint8_t {
    statements,           // top level of a file
    prototype_body,       // PROTO name [] { here }
    prototype_interface,  // PROTO name [ here ], EXTERNPROTO name [ here ]
    external_url,         // EXTERNPROTO name [] here
    node_body,            // Type { here }
    node_list,            // [ here ] of an MFNode
    values,               // [ here ] of any other MF type
    image,                // the pixels of an SFImage
    skip,                 // something that can't be used
  };
  Kind kind = Kind::statements;
  SourceLocation start;
  NodeId node;                                    // node_body
  const NodeType* type = nullptr;                 // node_body
  NodeType* declaring = nullptr;                  // interfaces and Script bodies: the type that grows
  FieldValue* into = nullptr;                     // node_list, values, image
  std::string_view name;                          // of the field that `into` belongs to
  std::unique_ptr<InterfaceDeclaration> pending;  // a declaration whose value is being read
  std::uint64_t fields_seen = 0;                  // node_body: a bit for each slot below 64
  std::array<double, 4> partial{};                // values: numbers of an element that is not whole yet
  std::uint8_t partial_count = 0;
  std::uint64_t pixels_left = 0;  // image
  std::size_t charged = 0;        // values, image: bytes of `into` that were drawn from the budget
  std::size_t depth = 0;          // skip: open brackets
  bool skipped_value = false;     // skip: something was skipped already
  bool value_unexpected = false;  // skip: there should be nothing to skip
};

/// A name scope (VRML97 4.4.3): the file, or the body of a PROTO.
struct Scope {
  struct UnresolvedRoute {
    std::string from, event_out, to, event_in;
    SourceLocation location;
  };
  NameTable names;  // a null node: one that was skipped
  std::unordered_map<std::string_view, const NodeType*> types;
  std::vector<UnresolvedRoute> unresolved_routes;
  NodeType* prototype = nullptr;  // whose body this is
};

struct Parser::State {
  State(SceneGraph& scene_graph, Diagnostics& diagnostic_list);

  // parser.cpp: the driver
  void run(const char* begin, const char* end, bool last);
  Step step();
  Step read_header();
  ParseOutcome close();
  void refuse(std::string message, SourceLocation location = {});
  void report(Severity severity, SourceLocation location, std::string message);
  void error(SourceLocation location, std::string message) { report(Severity::error, location, std::move(message)); }
  void warn(SourceLocation location, std::string message) { report(Severity::warning, location, std::move(message)); }
  /// "expected `what`, found ..."; of the end of the text only where nothing is open, since the open
  /// construct that it cuts short is reported anyway.
  void unexpected(const Token& found, const std::string& what);
  /// Complains of the first of several tokens in a row that have no use here, and passes over a list or node
  /// body that nobody asked for.
  void rubbish_token(const Token& token, const std::string& what);
  void warn_once(bool& said, SourceLocation location, std::string message);
  bool open(Frame frame);
  void report_end_inside(const Frame& frame);
  /// The budget for nodes is spent: says so, once. What follows is left out.
  bool out_of_budget();
  /// Draws what the list or image of a frame has grown by, in steps; `all`: to the last byte.
  void charge_growth(Frame& frame, bool all);

  // parser_statements.cpp: statements, node heads, ROUTE, PROTO
  Step statement_step();
  Step statement(const Token& keyword, bool& was_statement);
  Step other_statement(const Token& keyword);
  Step node_head(Token token, FieldValue* into);
  void place(NodeId node, FieldValue* into);
  void end_node();
  void check_measures(NodeId node);
  Step route_statement(SourceLocation location);
  bool read_node_event(std::string& node, std::string& event, Step& step);
  void add_route(const Scope::UnresolvedRoute& route, bool last_chance);
  Step prototype_head(bool external);
  Step interface_step();
  Step external_url_step();
  void finish_pending();
  void end_scope();
  void add_type(NodeType& type);
  void add_type_statement(const NodeType& type);
  void check_name(const Token& name);
  void check_reserved(const Token& name);
  [[nodiscard]] const NodeType* find_type(std::string_view name) const;
  [[nodiscard]] const NodeType* find_stand_in(const Token& name);
  [[nodiscard]] bool in_prototype_body() const { return scopes.back().prototype && interfaces_open == 0; }

  // parser_fields.cpp: node bodies, interface declarations, IS, recovery
  Step node_body_step();
  Step field(Token name);
  Step is_mapping(const Token& name);
  Step interface_declaration(AccessType access, NodeType& type, bool values, bool is_allowed);
  void check_role(NodeId node, std::string_view field);
  Step skip_step();
  void skip_value();
  void skip_interface_value();

  // parser_values.cpp: field values
  Step value(FieldType type, FieldValue& into, std::string_view name);
  void note_url_place(const Frame* node, std::string_view name, const Token& token);
  bool plain_floats(FieldType type, FieldValue& into);
  Step single_value(FieldType type, FieldValue& into, Token token, std::string_view name);
  Step image_head(FieldValue& into, Token token, std::string_view name);
  Step node_list_step();
  Step values_step();
  Step image_step();
  Step value_token(Frame& frame, const Token& token, const Lexer::Position& before);
  template <class T>
  void bulk_floats(Frame& frame, Array<T>& array);
  void bulk_integers(MFInt32& array);
  bool number_of(const Token& token, double& number);
  void cut_number(Token& token);
  String string_of(const Token& token);

  SceneGraph& scene;
  SourceText& source;  // what is read: of the scene's file, or one of its run-time texts
  Diagnostics& diagnostics;
  Lexer lexer;
  std::vector<Frame> frames;
  std::vector<Scope> scopes;
  std::string carry;           // bytes that came and could not be used yet
  std::size_t retry_size = 0;  // try again when `carry` has grown to this
  int interfaces_open = 0;     // PROTO interfaces that are being read, whose default nodes are live
  bool header_read = false;
  bool headerless = false;
  bool anything_read = false;
  bool table_text = false;  // interface text of our own: no header, no scene
  bool rubbish = false;     // the last token was rubbish and has been complained about
  bool end_reported = false;
  std::vector<std::unique_ptr<InterfaceDeclaration>> kept_values;   // of declarations that don't count
  std::unordered_set<std::string_view> said_types;                  // names that were declared twice
  std::unordered_map<std::string_view, const NodeType*> stand_ins;  // that were needed
  std::unordered_set<std::string> unknown_types;                    // that were told of
  std::unordered_set<std::uint64_t> said_measures;                  // places of nodes whose measures are none
  std::uint32_t said_reserved = 0;                                  // a bit for each of reserved_word()
  FieldValue discarded = MFNode{};             // takes named nodes that stand where nothing can be used
  FieldType number_type = FieldType::SFFloat;  // of the value that is being read
  bool said_bool_form = false, said_external_value = false, said_latin1 = false, said_route_in_list = false,
       said_bad_id = false, said_number_form = false, said_limit = false, said_budget = false;
  ParseOutcome outcome = ParseOutcome::complete;
};

/// `'text'` as an error shows it, shortened; "the end of the file"; ...
[[nodiscard]] std::string describe(const Token& token);

}  // namespace gs::vrml
