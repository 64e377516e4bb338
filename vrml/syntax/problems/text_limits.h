#pragma once

#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/problems/text_problems.h"

#include <cstddef>

namespace gs::vrml {

/// Limits that apply while one text is read into a scene. Draws memory from the scene's budget and reports the first
/// excess. Single-threaded.
class TextLimits {
 public:
  TextLimits(SceneGraph& scene, TextProblems& problems) : scene_(scene), problems_(problems) {}

  /// Returns true for the first excess of a limit; later ones are not reported.
  [[nodiscard]] bool is_first_excess();
  /// Reports whether the budget for nodes is exhausted, so that the grammar must omit the rest of the text.
  [[nodiscard]] bool is_exhausted(SourceLocation location);
  /// Reports whether a construct inside `depth` others may be opened.
  [[nodiscard]] bool admits_depth(std::size_t depth, SourceLocation location);
  /// Draws memory for a string of this size. Returns false if the string must stay empty.
  [[nodiscard]] bool admits_string(std::size_t bytes, SourceLocation location);
  /// Checks the first three numbers of an SFImage (VRML97 5.5).
  [[nodiscard]] bool admits_image(double width, double height, double components, SourceLocation location);
  /// Draws the growth of a list or an image since `charged` bytes, in steps; to the last byte if `all`.
  void charge_growth(const FieldValue& list, std::size_t& charged, bool all);

 private:
  SceneGraph& scene_;
  TextProblems& problems_;
  bool exceeded_ = false, exhausted_ = false;
};

}  // namespace gs::vrml
