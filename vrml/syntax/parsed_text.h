#pragma once

#include "vrml/syntax/lexer.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/scene_sink.h"

#include <array>
#include <memory>
#include <optional>
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

/// Text being parsed, with its open constructs, the scene that it describes, and the problems reported so far. The
/// parts of the parser share it.
struct ParsedText {
  ParsedText(SceneGraph& scene_graph, Diagnostics& diagnostic_list);

  /// Reads the first line, in text_header.cpp. Refuses texts of other formats.
  Step read_header();
  /// Ends all open constructs, and reports the innermost one.
  ParseOutcome close();
  void refuse(std::string message, SourceLocation location = {});
  /// Reports "expected `what`, found ...". At the end of the text it reports only if nothing is open, because the
  /// truncated construct is reported anyway.
  void unexpected(const Token& found, const std::string& what);
  /// Reports only the first of several consecutive unusable tokens, and skips an unexpected list or node body.
  void rubbish_token(const Token& token, const std::string& what);
  /// Reports once that the budget for nodes is exhausted. The rest of the text is omitted.
  bool out_of_budget();
  void report_end_inside(const Frame& frame);
  void check_name(const Token& name);
  void check_reserved(const Token& name);

  bool open(Frame frame);
  void skip_value();
  void end_node();
  void end_body();
  void finish_pending();

  SceneGraph& scene;
  SceneSink sink;
  TextProblems& problems;
  Lexer lexer;
  std::vector<Frame> frames;
  bool header_read = false;
  bool headerless = false;
  bool anything_read = false;
  bool table_text = false;  // text of the node table: no header, no scene
  bool rubbish = false;     // the last token was unusable and has been reported
  bool end_reported = false;
  std::uint32_t said_reserved = 0;  // bit mask of reserved_word() results that were reported
  bool said_bad_id = false;
  ParseOutcome outcome = ParseOutcome::complete;
};

/// Returns the access type with this keyword.
[[nodiscard]] std::optional<AccessType> access_named(std::string_view word);

/// Returns the token's text and position.
[[nodiscard]] inline SourceName name_in(const Token& token) { return {token.text, token.location}; }

/// Returns the token as an error shows it: `'text'`, shortened; "the end of the file"; ...
[[nodiscard]] std::string describe(const Token& token);

}  // namespace gs::vrml
