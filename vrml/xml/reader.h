#pragma once

#include "vrml/syntax/scene_reader.h"

#include <memory>
#include <string_view>
#include <vector>

namespace gs::vrml::xml {

/// Reader of X3D in the XML encoding (ISO/IEC 19776-1): a push parser on top of Expat. Plain tags and long lists of
/// numbers do not pass through Expat. External entities and document types are never loaded. After an error, the scene
/// contains everything before it.
class Reader final : public SceneReader {
 public:
  /// `scene` and `diagnostics` must outlive the reader.
  Reader(SceneGraph& scene, Diagnostics& diagnostics);
  ~Reader() override;

  void push(std::string_view piece) override;
  ParseOutcome finish() override;
  [[nodiscard]] std::vector<NodeId> open_nodes() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gs::vrml::xml
