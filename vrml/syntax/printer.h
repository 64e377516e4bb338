#pragma once

#include "vrml/scene/scene_graph.h"

#include <functional>
#include <string>
#include <string_view>

namespace gs::vrml {

/// Returns the scene as VRML97 text, or as classic X3D text if it is X3D, that parses to the same scene. It contains
/// PROTO and EXTERNPROTO declarations, nodes with their non-default fields, and ROUTEs, in the order of the file.
/// Printing the parsed text gives the same text again. A float has the fewest digits that give the same float. Shared
/// nodes without a name get a DEF name. Repeated names are made unique. print_scene() prints other grammars.
[[nodiscard]] std::string print(const SceneGraph& scene);
/// Prints in pieces of about one megabyte, because the text may be larger than the scene. `write` returns false to
/// stop.
void print(const SceneGraph& scene, const std::function<bool(std::string_view)>& write);

/// Appends one value as VRML97 text (clause 5) on one line. Nodes are printed as DEF names or types.
void print_value(std::string& out, const FieldValue& value, const SceneGraph& scene);

/// Returns the interface of a node type in the notation of a PROTO: one declaration per line, indented; its range
/// follows as a comment.
[[nodiscard]] std::string print_interface(const NodeType& type);

}  // namespace gs::vrml
