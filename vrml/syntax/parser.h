#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// How a text ended.
enum class ParseOutcome : std::uint8_t {
  complete,   // the whole text was read, maybe with errors
  truncated,  // it ended inside a statement; what came before stands in the scene
  refused,    // it is no VRML97: another format or version, binary, empty; the scene is empty
};

/// Reads VRML97 text (ISO/IEC 14772-1 Annex A) into a SceneGraph.
///
/// A push parser with an explicit stack: bytes may come whole or in pieces of any size, and the scene
/// and the diagnostics are the same either way; what has arrived stands in the scene at once, number
/// lists that are still open included. Never recurses, so nesting costs no stack.
///
/// Errors are recovered from at the next field, node or statement, so that the rest of the world still
/// shows. Safe for untrusted input. One thread.
class Parser {
 public:
  /// Both must outlive the parser. Diagnostics carry `scene.file_name()`.
  Parser(SceneGraph& scene, Diagnostics& diagnostics);
  ~Parser();
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  /// The next bytes of the text. Copies only what it cannot use yet.
  void push(std::string_view piece);
  /// The nodes whose bodies have begun and not ended, the outermost first: what will come changes them.
  [[nodiscard]] std::vector<NodeId> open_nodes() const;
  /// The text is over. Call once.
  ParseOutcome finish();
  /// A whole text in place of `push` and `finish`; copies nothing.
  ParseOutcome parse_whole(std::string_view text);
  /// The same for a text that needs no header, as scripts give it.
  ParseOutcome parse_fragment(std::string_view text);
  /// See `parse_interface`.
  [[nodiscard]] bool read_interface(std::string_view text, NodeType& type);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Parses a whole text.
ParseOutcome parse(std::string_view text, SceneGraph& scene, Diagnostics& diagnostics);

/// Nodes that were made at run time.
struct RunTimeNodes {
  MFNode roots;
  ParseOutcome outcome = ParseOutcome::complete;
};

/// Reads a text into a scene that lives, for createVrmlFromString and its like (VRML97 4.12.10): a text of its own,
/// with names and PROTOs of its own, which needs no header; nodes refer to it by Node::text. The nodes are in no field
/// yet: hold them (Execution::hold) before events go on, after Execution::attach. `written_by` is the text that asked
/// for this one; null means the scene's file. Its origin() must live as long as the scene. `fetched_from`: see
/// RunTimeText.
RunTimeNodes read_into(SceneGraph& scene, std::string file_name, std::string_view text, Diagnostics& diagnostics,
                       const SourceText* written_by = nullptr,
                       std::shared_ptr<const TextSource> fetched_from = nullptr);

/// Reads the interface declarations of a row of the node table (or of any PROTO) into `type`.
/// Used at start-up, for text of our own; false where the text is wrong.
[[nodiscard]] bool parse_interface(std::string_view text, NodeType& type);

}  // namespace gs::vrml
