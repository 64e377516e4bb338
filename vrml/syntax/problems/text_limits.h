#pragma once

#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/problems/text_problems.h"

#include <cstddef>

namespace gs::vrml {

/// Limits that apply while one text is read into a scene. Draws memory from the scene's budget, and reports the first
/// limit that is exceeded. One thread.
class TextLimits {
 public:
  TextLimits(SceneGraph& scene, TextProblems& problems) : scene_(scene), problems_(problems) {}

  /// Returns true only in the first call, so that only the first excess of a limit is reported.
  [[nodiscard]] bool is_first_excess();
  /// Reports whether the budget for nodes is exhausted, so that the grammar must omit the rest of the text.
  [[nodiscard]] bool is_exhausted(SourceLocation location);
  /// Reports whether a construct may be opened inside `depth` other constructs.
  [[nodiscard]] bool admits_depth(std::size_t depth, SourceLocation location);
  /// Draws memory for a string of `bytes` bytes. Returns false if there is not enough; the string must then stay empty.
  [[nodiscard]] bool admits_string(std::size_t bytes, SourceLocation location);
  /// Checks width, height and components, the first three numbers of an SFImage (VRML97 5.5). Returns false if it
  /// exceeds a limit.
  [[nodiscard]] bool admits_image(double width, double height, double components, SourceLocation location);
  /// Draws memory for the growth of a list or image. `charged` is the number of bytes drawn so far. Draws in steps, or
  /// exactly if `all` is set.
  void charge_growth(const FieldValue& list, std::size_t& charged, bool all);

 private:
  SceneGraph& scene_;
  TextProblems& problems_;
  bool exceeded_ = false, exhausted_ = false;
};

}  // namespace gs::vrml
