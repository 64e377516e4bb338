#pragma once

#include "vrml/scene/scene_graph.h"

#include <string_view>

namespace gs::vrml {

/// What takes the place of a node type that other browsers brought along, as worlds for Blaxxun Contact and Cosmo
/// Player use them without a PROTO of their own: a PROTO of that name in a library of `scene`, out of a table that is
/// written in VRML97. Null where the table has no such name. Made anew by each call.
[[nodiscard]] const NodeType* stand_in(SceneGraph& scene, std::string_view name);

/// The built-in node type that one of the urls of an EXTERNPROTO means, as `urn:web3d:vrml97:node:Shape` does, or
/// `urn:inet:blaxxun.com:node:Shape`; null: none does.
[[nodiscard]] const NodeType* built_in_node_of_urn(const MFString& urls);

/// For an EXTERNPROTO of `scene` that cannot be had: that of its name; else the node type, built in or of the table, that
/// an `urn:` of its urls means; else, where it declares an MFNode field `children`, a Group of these; else null.
[[nodiscard]] const NodeType* stand_in_for(SceneGraph& scene, const NodeType& external);

/// Whether what a stand-in shows is fixed to the viewer, and so seen over everything else.
[[nodiscard]] bool is_overlay(const NodeType& type);

}  // namespace gs::vrml
