#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// End state of a parse.
enum class ParseOutcome : std::uint8_t {
  complete,   // the whole text was read, possibly with errors
  truncated,  // the text ended inside a statement; the scene contains the part before
  refused,    // the text is not VRML97 (other format or version, binary, empty); the scene is empty
};

/// Reads VRML97 text (ISO/IEC 14772-1 Annex A) into a SceneGraph.
///
/// Push parser with an explicit stack. Bytes may come whole or in pieces of any size; the scene and the diagnostics are
/// the same. The scene contains all received data at once, even of open number lists. Without recursion, so that
/// nesting needs no call stack.
///
/// After an error it continues at the next field, node or statement, so that the rest of the world is shown. Accepts
/// untrusted input. Single-threaded.
class Parser {
 public:
  /// `scene` and `diagnostics` must outlive the parser. Diagnostics carry `scene.file_name()`.
  Parser(SceneGraph& scene, Diagnostics& diagnostics);
  ~Parser();
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  /// Parses the next bytes of the text. Copies only bytes that it cannot use yet.
  void push(std::string_view piece);
  /// Returns the nodes with an open body, outermost first; later bytes may change them.
  [[nodiscard]] std::vector<NodeId> open_nodes() const;
  /// Ends the text. Call once.
  ParseOutcome finish();
  /// Parses a whole text instead of `push` and `finish`; copies nothing.
  ParseOutcome parse_whole(std::string_view text);
  /// Like parse_whole(), for text of scripts, which needs no header.
  ParseOutcome parse_fragment(std::string_view text);
  /// See `parse_interface`.
  [[nodiscard]] bool read_interface(std::string_view text, NodeType& type);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Parses a whole text.
ParseOutcome parse(std::string_view text, SceneGraph& scene, Diagnostics& diagnostics);

/// Nodes made at run time.
struct RunTimeNodes {
  MFNode roots;
  ParseOutcome outcome = ParseOutcome::complete;
};

/// Reads a text into a running scene, for createVrmlFromString and similar functions (VRML97 4.12.10). The text needs
/// no header and has its own names and PROTOs; nodes refer to it by Node::text. The nodes are not in any field yet:
/// after WorldScenes::attach, hold them (NodeLifetime::hold) before events are delivered. `written_by` is the text that
/// requested this one; null means the scene's file. Its origin() must live as long as the scene. For `fetched_from` see
/// RunTimeText.
RunTimeNodes read_into(SceneGraph& scene, std::string file_name, std::string_view text, Diagnostics& diagnostics,
                       const SourceText* written_by = nullptr,
                       std::shared_ptr<const TextSource> fetched_from = nullptr);

/// Reads the interface declarations of a row of the node table (or of any PROTO) into `type`. Used at start-up for
/// built-in text. Returns false if the text is invalid.
[[nodiscard]] bool parse_interface(std::string_view text, NodeType& type);

}  // namespace gs::vrml
