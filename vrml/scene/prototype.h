#pragma once

#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

/// Gives a PROTO instance the nodes of its body: copies them into the instance's scene, hands the
/// instance's values to the fields that IS names (VRML97 4.8.2, 4.8.3), copies the body's ROUTEs, and
/// goes on with the instances inside. Does nothing for a node that is no PROTO instance, is part of a
/// PROTO's declaration or has content already. False when limits stopped it; what is missing stays empty. An instance
/// that cannot have all its nodes gets none.
bool instantiate(SceneGraph& scene, NodeId instance);

/// The text in which the value of an instance's field was written: that of the instance, where it gives
/// one, else that of the PROTO, whose default it is.
[[nodiscard]] const SourceText& text_of_field(const SceneGraph& scene, NodeId instance,
                                              const InterfaceDeclaration& field);

/// Gives an EXTERNPROTO of `scene` the body of PROTO `source` (VRML97 4.9), whose scene must be attached
/// to `scene` as a library or live as long. Fields that an instance does not set get `source`'s defaults,
/// and all instances that the scene has are instantiated. False when limits stopped it.
bool resolve_external(SceneGraph& scene, NodeType& external, const NodeType& source);

/// The first declaration of an EXTERNPROTO that PROTO `source` lacks, or has of another type or for other use, which
/// 4.9.2 forbids; null: there is none. What is an exposedField of the PROTO may be declared as each part of it.
[[nodiscard]] const InterfaceDeclaration* unlike_prototype(const NodeType& external, const NodeType& source);

/// Counts what one instance of a PROTO, whose body is complete, makes with all the instances in it.
void count_instance_nodes(const SceneGraph& scene, Prototype& prototype);

/// Why an instance of this type has no content, or not all of it.
[[nodiscard]] std::string why_not_expanded(const SceneGraph& scene, const NodeType& type);

/// The PROTO of `text` that `#name` of an EXTERNPROTO url means: the one of that name, or, without a
/// name, the first (VRML97 4.9.2). Null where there is none.
[[nodiscard]] const NodeType* find_prototype(const SourceText& text, std::string_view name);

/// The PROTO that a url list of an EXTERNPROTO means which names the file it stands in: the complete one of that name,
/// or, without a name, the first that is no EXTERNPROTO itself. Null where there is none (yet).
[[nodiscard]] const NodeType* find_own_prototype(const SourceText& text, std::string_view name);

/// Whether a node of `type` stands in the body of PROTO `source`, or in that of one whose instance does.
[[nodiscard]] bool stands_inside(const NodeType& type, const NodeType& source);

}  // namespace gs::vrml
