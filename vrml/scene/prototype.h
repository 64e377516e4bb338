#pragma once

#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

/// Expands a PROTO instance: copies the nodes and ROUTEs of the body into the scene of the instance, and passes values
/// of the instance through IS (VRML97 4.8.2, 4.8.3). Expands nested instances, too. Does nothing for other nodes, for
/// nodes in a PROTO declaration, and for expanded instances. Returns false if limits or a cancellation stopped it. An
/// instance gets either all of its nodes or none; nested instances without memory stay empty.
bool instantiate(SceneGraph& scene, NodeId instance);

/// Returns the text in which the value of an instance's field was written. If the instance sets the field, this is the
/// text of the instance; otherwise the text of the PROTO, which has the default.
[[nodiscard]] const SourceText& text_of_field(const SceneGraph& scene, NodeId instance,
                                              const InterfaceDeclaration& field);

/// Gives an EXTERNPROTO of `scene` the body of the PROTO `source` (VRML97 4.9), and expands all its instances in the
/// scene. The scene of `source` must be attached to `scene` as a library, or live as long as `scene`. Fields that an
/// instance does not set get the defaults of `source`. Returns false if limits stopped it.
bool resolve_external(SceneGraph& scene, NodeType& external, const NodeType& source);

/// Returns the first declaration of an EXTERNPROTO that the PROTO `source` lacks, or has with another type or access;
/// 4.9.2 forbids both. Returns null if there is none. An exposedField of the PROTO may be declared as its field, its
/// eventIn or its eventOut.
[[nodiscard]] const InterfaceDeclaration* unlike_prototype(const NodeType& external, const NodeType& source);

/// Counts the nodes and bytes of one instance of a complete PROTO, including nested instances. Stores them in
/// `prototype`.
void count_instance_nodes(const SceneGraph& scene, Prototype& prototype);

/// Returns the reason why an instance of this type has no nodes, or only some of them.
[[nodiscard]] std::string why_not_expanded(const SceneGraph& scene, const NodeType& type);

/// Returns the PROTO of `text` for `#name` in the url of an EXTERNPROTO (VRML97 4.9.2): the PROTO with that name, or
/// the first PROTO if `name` is empty. Returns null if there is none.
[[nodiscard]] const NodeType* find_prototype(const SourceText& text, std::string_view name);

/// Returns the PROTO for an EXTERNPROTO with a url that refers to its own file. This is the complete PROTO with that
/// name, or the first one that is not an EXTERNPROTO if `name` is empty. Returns null if there is none yet.
[[nodiscard]] const NodeType* find_own_prototype(const SourceText& text, std::string_view name);

/// Reports whether the body of the PROTO `source` contains a node of `type`, directly or in nested instances.
[[nodiscard]] bool stands_inside(const NodeType& type, const NodeType& source);

}  // namespace gs::vrml
