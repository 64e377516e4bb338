#pragma once

#include "vrml/scene/scene_graph.h"

#include <string_view>

namespace gs::vrml {

/// Returns a PROTO that substitutes a node type of other browsers, which worlds for Blaxxun Contact and Cosmo Player
/// use without declaring it. It comes from a table in VRML97 and becomes a library of `scene`; each call makes a new
/// one. Returns null if the table has no such name.
[[nodiscard]] const NodeType* stand_in(SceneGraph& scene, std::string_view name);

/// Returns the built-in node type that a url of an EXTERNPROTO names, such as `urn:web3d:vrml97:node:Shape` or
/// `urn:inet:blaxxun.com:node:Shape`; null if none does.
[[nodiscard]] const NodeType* built_in_node_of_urn(const MFString& urls);

/// Returns a substitute for an EXTERNPROTO of `scene` that cannot be loaded: the stand-in of its name; else the type,
/// built in or of the table, that a `urn:` url names; else a Group if it declares an MFNode field `children`; else
/// null.
[[nodiscard]] const NodeType* stand_in_for(SceneGraph& scene, const NodeType& external);

/// Reports whether a stand-in's content is fixed to the viewer and drawn over everything else.
[[nodiscard]] bool is_overlay(const NodeType& type);

}  // namespace gs::vrml
