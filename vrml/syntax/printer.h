#pragma once

#include "vrml/scene/scene_graph.h"

#include <functional>
#include <string>
#include <string_view>

namespace gs::vrml {

/// The scene as VRML97 text that parses to the same scene: PROTO and EXTERNPROTO declarations, nodes with
/// the fields that differ from their defaults, ROUTEs, in the order of the file. Printing what this text
/// parses to gives the same text again. Floats are printed with the fewest digits that give the same
/// float. Nodes that several places use get a DEF name if they have none, and names that were given
/// twice are told apart.
[[nodiscard]] std::string print(const SceneGraph& scene);
/// The same in pieces of about a megabyte, which `write` gets: the whole may be larger than the scene. False ends it.
void print(const SceneGraph& scene, const std::function<bool(std::string_view)>& write);

/// Appends one value as VRML97 text (clause 5), on one line; node values as their DEF names or types.
void print_value(std::string& out, const FieldValue& value, const SceneGraph& scene);

/// The interface of a node type as a PROTO declares it, one declaration a line, indented, the range in a
/// comment behind it.
[[nodiscard]] std::string print_interface(const NodeType& type);

}  // namespace gs::vrml
