#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/scene_reader.h"

#include <memory>
#include <string_view>
#include <vector>

namespace gs::vrml::inventor {

/// Reader of VRML 1.0 and ASCII Inventor (1.0 to 2.1), which it converts to VRML97 nodes.
///
/// The text may be received in pieces of any size. A node at the top level is converted when its closing brace is
/// received; most files have only one. After an error the reader continues at the next field or node. Safe for
/// untrusted text: text, nodes, nesting and repeated uses are limited. One thread.
class Reader final : public SceneReader {
 public:
  /// `scene` and `diagnostics` must outlive the reader. Diagnostics contain `scene.file_name()`.
  Reader(SceneGraph& scene, Diagnostics& diagnostics);
  ~Reader() override;

  /// Receives the next bytes of the text, and converts the nodes that are complete.
  void push(std::string_view piece) override;
  /// Ends the text. Call it once, after the last push().
  ParseOutcome finish() override;
  /// Returns no nodes, because all nodes in the scene are complete.
  [[nodiscard]] std::vector<NodeId> open_nodes() const override { return {}; }

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gs::vrml::inventor
