#pragma once

#include "base/diagnostic.h"
#include "base/noncopyable.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/scene/x3d/language.h"

#include <memory>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Outcome of reading a text.
enum class ParseOutcome : std::uint8_t {
  complete,   // the whole text was read; errors may have been reported
  truncated,  // the text ended inside a statement; the scene contains everything before that point
  refused,    // the text is of no grammar of this room (other format or version, binary, empty); the scene is empty
};

/// Reader of one encoding of scenes into a SceneGraph. The text may be received in pieces of any size; scene and
/// diagnostics are the same. Safe for untrusted text. One thread.
class SceneReader : NonCopyable {
 public:
  virtual ~SceneReader() = default;

  /// Reads the next bytes of the text.
  virtual void push(std::string_view piece) = 0;
  /// Ends the text. Call it once, after the last push().
  virtual ParseOutcome finish() = 0;
  /// Returns the nodes with an open body, outermost first. Later bytes may change these nodes.
  [[nodiscard]] virtual std::vector<NodeId> open_nodes() const = 0;
};

/// Returns the grammar of a text by its first 8 KiB: by the header line of VRML, X3D and Inventor, or by the root
/// element or member `X3D`. Returns vrml97 for other texts, because its parser reports the best errors.
[[nodiscard]] Grammar grammar_of(std::string_view first_bytes);

/// Makes the reader for a grammar. `scene` and `diagnostics` must outlive it. Diagnostics contain `scene.file_name()`.
[[nodiscard]] std::unique_ptr<SceneReader> make_reader(Grammar grammar, SceneGraph& scene, Diagnostics& diagnostics);

}  // namespace gs::vrml
