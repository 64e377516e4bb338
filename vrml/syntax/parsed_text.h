#pragma once

#include "vrml/syntax/parser.h"
#include "vrml/syntax/scene_sink.h"
#include "vrml/syntax/tokens/lexer.h"

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
  need_more_kept,  // more bytes are needed; the part of the list that was read is kept
  finished,        // the text has ended
};

/// Open construct. The stack of frames is the complete state of the parser.
struct Frame {
  enum class Kind : std::uint8_t {
    statements,           // statements at the top level of a file
    prototype_body,       // body of a PROTO, in its braces
    prototype_interface,  // interface of a PROTO or EXTERNPROTO, in its brackets
    external_url,         // url of an EXTERNPROTO, after its brackets
    node_body,            // body of a node, in its braces
    node_list,            // list of an MFNode, in its brackets
    values,               // list of any other MF type, in its brackets
    image,                // pixels of an SFImage
    image_list,           // list of an MFImage, in its brackets, or one image of it
    skip,                 // rest of an unusable construct, which is skipped
  };
  Kind kind = Kind::statements;
  SourceLocation start;
  OpenNode node;                  // for node_body
  NodeType* declaring = nullptr;  // for interfaces and Script bodies: the type that is being declared
  FieldValue* into = nullptr;     // for node_list, values, image, image_list: storage of the value
  std::string_view name;          // for values, image, image_list: name of the field; for node_list: see NodeTarget
  std::unique_ptr<InterfaceDeclaration> pending;  // declaration with an incomplete value
  std::uint64_t pixels_left = 0;                  // for image: number of pixels still to read
  std::size_t charged = 0;                        // for values, image: bytes of `into` charged to the budget
  std::size_t depth = 0;                          // for skip: number of open brackets
  bool skipped_value = false;                     // for skip: a part was skipped already
  bool single = false;                            // for image_list: one image without brackets
  bool value_unexpected = false;                  // for skip: any content is an error
};

/// Text being parsed, with its open constructs, the scene that it describes, and the problems reported so far. The
/// parts of the parser share it.
struct ParsedText {
  ParsedText(SceneGraph& scene_graph, Diagnostics& diagnostic_list);

  /// Reads the first line, in text_header.cpp. Refuses texts of other formats.
  Step read_header();
  Step read_x3d_header(std::string_view line, std::string_view text);
  /// Takes the language from a header in a text from a script, which needs none.
  void read_fragment_header(std::string_view text);
  /// Ends all open constructs, and reports the innermost one.
  ParseOutcome close();
  void refuse(std::string message, SourceLocation location = {});
  /// Reports "expected `what`, found ...". At the end of the text, reports only if no construct is open: a truncated
  /// construct is reported elsewhere.
  void unexpected(const Token& found, const std::string& what);
  /// Reports an unusable token, but only the first of several in a row. Skips an unexpected list or node body.
  void rubbish_token(const Token& token, const std::string& what);
  /// Reports whether reading was cancelled (Budget::stopped()); the rest of the text is then omitted.
  [[nodiscard]] bool is_stopped();
  /// Reports once that the budget for nodes is exhausted. Returns true if it is; the rest of the text is then omitted.
  bool out_of_budget();
  void report_end_inside(const Frame& frame);
  void check_name(const Token& name);
  void check_reserved(const Token& name);

  bool open(Frame frame);
  void skip_value();
  void end_node();
  void end_body();
  [[nodiscard]] Language language() const { return written.language(); }
  /// Begins to read X3D: its statements, comments and access keywords.
  void begin_x3d(int version, SourceLocation location);
  void finish_pending();

  SceneGraph& scene;
  SourceText& written;  // text that is read
  SceneSink sink;
  TextProblems& problems;
  Lexer lexer;
  std::vector<Frame> frames;
  bool header_read = false;
  bool headerless = false;
  Language headerless_language = Language::vrml97;  // language of a text without a header
  bool anything_read = false;
  bool table_text = false;  // the text is a part of the node table: no header, no scene
  bool rubbish = false;     // the last token was unusable and was reported
  bool end_reported = false;
  bool stopped = false;             // reading was cancelled
  std::uint32_t steps = 0;          // number of calls of is_stopped()
  std::uint32_t said_reserved = 0;  // one bit per reserved_word() index that was reported
  bool said_bad_id = false;
  ParseOutcome outcome = ParseOutcome::complete;
};

/// Returns the access type with this keyword. X3D texts may also contain the keywords of VRML97.
[[nodiscard]] std::optional<AccessType> access_named(std::string_view word, Language language);

/// Returns the token's text and position.
[[nodiscard]] inline SourceName name_in(const Token& token) { return {token.text, token.location}; }

/// Returns a description of the token for errors: `'text'`, shortened; "the end of the file"; ...
[[nodiscard]] std::string describe(const Token& token);

}  // namespace gs::vrml
