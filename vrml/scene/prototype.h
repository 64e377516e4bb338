#pragma once

#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

/// Expands a PROTO instance: copies the body's nodes into the instance's scene, passes the instance's values through IS
/// (VRML97 4.8.2, 4.8.3), copies the body's ROUTEs, and expands nested instances. Does nothing for other nodes, for
/// nodes in a PROTO declaration, and for expanded instances. Returns false if limits or cancellation stopped it. An
/// instance gets either all of its nodes or none; nested instances without room stay empty.
bool instantiate(SceneGraph& scene, NodeId instance);

/// Returns the text in which the value of an instance's field was written: the instance's text if it sets the field,
/// else the PROTO's, for its default.
[[nodiscard]] const SourceText& text_of_field(const SceneGraph& scene, NodeId instance,
                                              const InterfaceDeclaration& field);

/// Gives an EXTERNPROTO of `scene` the body of PROTO `source` (VRML97 4.9) and expands all instances in the scene. The
/// scene of `source` must be attached to `scene` as a library, or live as long. Fields that an instance does not set
/// get the defaults of `source`. Returns false if limits stopped it.
bool resolve_external(SceneGraph& scene, NodeType& external, const NodeType& source);

/// Returns the first declaration of an EXTERNPROTO that PROTO `source` lacks or declares with another type or access,
/// which 4.9.2 forbids; null if there is none. An exposedField of the PROTO may be declared as any of its parts.
[[nodiscard]] const InterfaceDeclaration* unlike_prototype(const NodeType& external, const NodeType& source);

/// Counts the nodes and bytes of one instance of a complete PROTO, including nested instances.
void count_instance_nodes(const SceneGraph& scene, Prototype& prototype);

/// Returns the reason why an instance of this type has no content, or only a part.
[[nodiscard]] std::string why_not_expanded(const SceneGraph& scene, const NodeType& type);

/// Returns the PROTO of `text` for `#name` in an EXTERNPROTO url: the one of that name, or the first if `name` is empty
/// (VRML97 4.9.2). Null if there is none.
[[nodiscard]] const NodeType* find_prototype(const SourceText& text, std::string_view name);

/// Returns the PROTO for an EXTERNPROTO url that refers to its own file: the complete one of that name, or the first
/// that is no EXTERNPROTO if `name` is empty. Null if there is none yet.
[[nodiscard]] const NodeType* find_own_prototype(const SourceText& text, std::string_view name);

/// Reports whether the body of PROTO `source` contains a node of `type`, directly or through nested instances.
[[nodiscard]] bool stands_inside(const NodeType& type, const NodeType& source);

}  // namespace gs::vrml
