#pragma once

#include "vrml/scene/scene_graph.h"

#include <string_view>

namespace gs::vrml {

/// Returns a PROTO that replaces a node type of other browsers. Worlds for Blaxxun Contact and Cosmo Player use such
/// types without declaring them. The PROTO comes from a table in VRML97 notation, and becomes a library of `scene`.
/// Each call makes a new PROTO. Returns null if the table does not contain the name.
[[nodiscard]] const NodeType* stand_in(SceneGraph& scene, std::string_view name);

/// Returns the built-in node type that one of the urls of an EXTERNPROTO names, such as `urn:web3d:vrml97:node:Shape`
/// or `urn:inet:blaxxun.com:node:Shape`. Returns null if no url names one.
[[nodiscard]] const NodeType* built_in_node_of_urn(const MFString& urls);

/// Returns a substitute for an EXTERNPROTO of `scene` that cannot be loaded. The first choice is the stand-in with its
/// name. The second is the type, built in or from the table, that a `urn:` url names. The third is a Group, if the
/// EXTERNPROTO declares an MFNode field `children`. Returns null if none applies.
[[nodiscard]] const NodeType* stand_in_for(SceneGraph& scene, const NodeType& external);

/// Reports whether the content of a stand-in is fixed to the viewer and drawn over everything else.
[[nodiscard]] bool is_overlay(const NodeType& type);

}  // namespace gs::vrml
