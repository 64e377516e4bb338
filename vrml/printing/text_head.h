#pragma once

#include "vrml/scene/scene_graph.h"
#include "vrml/scene/x3d/language.h"

#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Statements before the nodes of a text.
struct TextHead {
  Grammar grammar = Grammar::vrml97;
  int version = 20;                                       // in tenths
  std::string profile = {};                               // X3D only
  std::vector<X3DStatements::Component> components = {};  // X3D only: components that the profile lacks, sorted by name

  std::vector<X3DStatements::Unit> units = {};  // only of lengths, because other values are in base units
  std::vector<X3DStatements::Meta> metas = {};

  /// Returns the version as in headers: "3.3".
  [[nodiscard]] std::string version_text() const {
    return std::to_string(version / 10) + '.' + std::to_string(version % 10);
  }
};

class NodeTranslator;

/// Returns the head of a text with a scene. In X3D, the profile and the components suffice for the nodes of the scene
/// (ISO/IEC 19775-1 4.5.3): the smallest profile that has them, else Immersive with further components. A scene that is
/// not X3D becomes X3D 3.3, which has the lighting of VRML97.
[[nodiscard]] TextHead text_head(const SceneGraph& scene, Grammar grammar, NodeTranslator& translator);

}  // namespace gs::vrml
