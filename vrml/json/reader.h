#pragma once

#include "vrml/syntax/scene_reader.h"

#include <memory>
#include <string_view>
#include <vector>

namespace gs::vrml::json {

/// Reader of X3D in the JSON encoding (ISO/IEC 19776-5): a push parser with an explicit stack. Lists of numbers go
/// straight into their fields. Members may come in any order. Forgives missing commas, comments of other tools and
/// numbers as strings.
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

}  // namespace gs::vrml::json
