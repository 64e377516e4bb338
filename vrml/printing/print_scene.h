#pragma once

#include "vrml/scene/scene_graph.h"
#include "vrml/scene/x3d/language.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Form of a printed scene.
struct PrintOptions {
  Grammar grammar = Grammar::vrml97;  // not Grammar::inventor
  /// Function that returns the changed list of a url field, or nullopt if it remains. Empty for no changes.
  std::function<std::optional<MFString>(const MFString&)> moved_urls = {};
};

/// Returns the grammar that prints a scene without conversion: VRML97, or the classic VRML encoding of X3D.
[[nodiscard]] Grammar own_grammar(const SceneGraph& scene);

/// Prints a scene as a text of any grammar. It contains PROTO and EXTERNPROTO declarations, nodes with the fields that
/// differ from their defaults, and ROUTEs, in the order of the file. Nodes of the other language get its names
/// (Switch.choice is `children` in X3D). Nodes that only X3D has become their equivalents in VRML97, or are left out.
///
/// Reading the text and printing it again gives the same text. Passes the text in pieces of about one megabyte; `write`
/// returns false to stop. Returns the properties that the text lacks, as messages for the user.
std::vector<std::string> print_scene(const SceneGraph& scene, const PrintOptions& options,
                                     const std::function<bool(std::string_view)>& write);
/// Returns the whole text.
[[nodiscard]] std::string printed_scene(const SceneGraph& scene, const PrintOptions& options);

}  // namespace gs::vrml
