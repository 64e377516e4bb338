#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/scene_reader.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Parser of VRML97 text (ISO/IEC 14772-1 Annex A) into a SceneGraph.
///
/// A push parser with an explicit stack. The text may be received as a whole or in pieces of any size; scene and
/// diagnostics are the same. The scene contains all received data at once, even from lists of numbers that are not
/// complete. Does not use recursion, so that nesting needs no call stack.
///
/// After an error it continues at the next field, node or statement, so that the rest of the world is drawn. Safe for
/// untrusted text. One thread.
class Parser final : public SceneReader {
 public:
  /// `scene` and `diagnostics` must outlive the parser. Diagnostics contain `scene.file_name()`.
  Parser(SceneGraph& scene, Diagnostics& diagnostics);
  ~Parser() override;

  /// Sets the language of a text without a header, which is VRML97 otherwise. Call it before push().
  void set_headerless_language(Language language);
  /// Parses the next bytes of the text. Copies only bytes that form an incomplete token or statement.
  void push(std::string_view piece) override;
  /// Returns the nodes with an open body, outermost first. Later bytes may change these nodes.
  [[nodiscard]] std::vector<NodeId> open_nodes() const override;
  /// Ends the text. Call it once, after the last push().
  ParseOutcome finish() override;
  /// Parses a whole text without copying it. Replaces `push` and `finish`.
  ParseOutcome parse_whole(std::string_view text);
  /// Like parse_whole(), for text from scripts, which needs no header.
  ParseOutcome parse_fragment(std::string_view text);
  /// Implements parse_interface().
  [[nodiscard]] bool read_interface(std::string_view text, NodeType& type);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Parses a whole text of any grammar into `scene`.
ParseOutcome parse(std::string_view text, SceneGraph& scene, Diagnostics& diagnostics);

/// Result of read_into(): the top-level nodes that were made at run time.
struct RunTimeNodes {
  MFNode roots;
  ParseOutcome outcome = ParseOutcome::complete;
};

/// Reads a text into a running scene, for createVrmlFromString and similar functions (VRML97 4.12.10). The text may
/// have any grammar. Without a header, it has the language of `written_by`. It has separate names and PROTOs. Node::text of its nodes refers to it.
/// The nodes do not belong to any field yet. After WorldScenes::attach, call NodeLifetime::hold for them before events
/// are delivered. `written_by` is the text that requested this text; null means the scene's file. Its origin() must
/// live as long as the scene. RunTimeText describes `fetched_from`.
RunTimeNodes read_into(SceneGraph& scene, std::string file_name, std::string_view text, Diagnostics& diagnostics,
                       const SourceText* written_by = nullptr,
                       std::shared_ptr<const TextSource> fetched_from = nullptr);

/// Reads the interface declarations of a row of the node table, or of any PROTO, into `type`. For built-in text at
/// start-up. Returns false if the text is invalid.
[[nodiscard]] bool parse_interface(std::string_view text, NodeType& type);

}  // namespace gs::vrml
