#pragma once

#include "vrml/syntax/lexer.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/scene_sink.h"

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Result of one step of the parser.
enum class Step : std::uint8_t {
  done,            // something was read
  need_more,       // nothing was read; more bytes are needed
  need_more_kept,  // more bytes are needed; the part of this list read so far counts
  finished,        // nothing is left to read
};

/// One open construct. The stack of frames is the parser's complete state.
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
    skip,                 // something unusable, being skipped
  };
  Kind kind = Kind::statements;
  SourceLocation start;
  OpenNode node;                                  // node_body
  NodeType* declaring = nullptr;                  // interfaces and Script bodies: the type being declared
  FieldValue* into = nullptr;                     // node_list, values, image
  std::string_view name;                          // values, image: name of the field; node_list: see NodeTarget
  std::unique_ptr<InterfaceDeclaration> pending;  // declaration with a value still to read
  std::array<double, 4> partial{};                // values: numbers of an incomplete element
  std::uint8_t partial_count = 0;
  std::uint64_t pixels_left = 0;  // image
  std::size_t charged = 0;        // values, image: bytes of `into` drawn from the budget
  std::size_t depth = 0;          // skip: open brackets
  bool skipped_value = false;     // skip: something was skipped already
  bool value_unexpected = false;  // skip: any content is unexpected
};

struct Parser::State {
  State(SceneGraph& scene_graph, Diagnostics& diagnostic_list);

  // Driver, in parser.cpp.
  void run(const char* begin, const char* end, bool last);
  Step step();
  Step read_header();
  ParseOutcome close();
  void refuse(std::string message, SourceLocation location = {});
  /// Reports "expected `what`, found ...". At the end of the text it reports only if nothing is open, because the
  /// truncated construct is reported anyway.
  void unexpected(const Token& found, const std::string& what);
  /// Reports only the first of several consecutive unusable tokens, and skips an unexpected list or node body.
  void rubbish_token(const Token& token, const std::string& what);
  bool open(Frame frame);
  void report_end_inside(const Frame& frame);
  /// Reports once that the budget for nodes is exhausted. The rest of the text is omitted.
  bool out_of_budget();

  // Statements, node heads, ROUTE, PROTO, in parser_statements.cpp.
  Step statement_step();
  Step statement(const Token& keyword, bool& was_statement);
  Step other_statement(const Token& keyword);
  Step node_head(Token token, NodeTarget target);
  void end_node();
  Step route_statement(SourceLocation location);
  bool read_node_event(std::string& node, std::string& event, Step& step);
  Step prototype_head(bool external);
  Step interface_step();
  Step external_url_step();
  void finish_pending();
  void end_body();
  void check_name(const Token& name);
  void check_reserved(const Token& name);

  // Node bodies, interface declarations, IS and recovery, in parser_fields.cpp.
  Step node_body_step();
  Step field(Token name);
  Step is_mapping(const Token& name);
  Step interface_declaration(AccessType access, NodeType& type, bool values, bool is_allowed);
  Step skip_step();
  void skip_value();
  void skip_interface_value();

  // Field values, in parser_values.cpp.
  Step value(FieldType type, FieldValue& into, std::string_view name, std::string_view restricts);
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
  SceneSink sink;
  TextProblems& problems;
  Lexer lexer;
  std::vector<Frame> frames;
  std::string carry;           // received bytes that cannot be used yet
  std::size_t retry_size = 0;  // size of `carry` at which to retry
  bool header_read = false;
  bool headerless = false;
  bool anything_read = false;
  bool table_text = false;  // text of the node table: no header, no scene
  bool rubbish = false;     // the last token was unusable and has been reported
  bool end_reported = false;
  std::vector<std::unique_ptr<InterfaceDeclaration>> kept_values;  // values of invalid declarations
  std::uint32_t said_reserved = 0;             // bit mask of reserved_word() results that were reported
  FieldValue discarded = MFNode{};             // receives named nodes that cannot be used
  FieldType number_type = FieldType::SFFloat;  // of the value being read
  bool said_bool_form = false, said_external_value = false, said_latin1 = false, said_route_in_list = false,
       said_bad_id = false, said_number_form = false;
  ParseOutcome outcome = ParseOutcome::complete;
};

/// Returns the token's text and position.
[[nodiscard]] inline SourceName name_in(const Token& token) { return {token.text, token.location}; }

/// Returns the token as an error shows it: `'text'`, shortened; "the end of the file"; ...
[[nodiscard]] std::string describe(const Token& token);

}  // namespace gs::vrml
