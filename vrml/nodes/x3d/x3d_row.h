#pragma once

#include "vrml/scene/node_type.h"

#include <string_view>

namespace gs::vrml {

/// Row of the node table for X3D (ISO/IEC 19775-1): one node type with its full X3D interface, without `metadata`,
/// which each type has.
///
/// If VRML97 has a node of this name, the type also has the interfaces of the VRML97 row, in the same slots, and the
/// columns of that row replace the columns that are not set here. Interfaces that X3D names differently are in
/// kRenamed of node_type_table.cpp.
struct X3DRow {
  std::string_view name;
  std::string_view component;
  int level;
  std::string_view container_field;  // default field of the parent in the XML encoding (ISO/IEC 19776-1)
  std::string_view bases;            // abstract types that it derives from, separated by blanks
  Role role;
  NodeKind read_as;
  /// One declaration per line in the notation of VRML97. Its range follows as a comment; for nodes, the comment lists
  /// the types that the field accepts.
  std::string_view interface_text;
  Tessellator tessellator{};
  const Behaviour* behaviour = nullptr;
  UrlContent url_content = UrlContent::none;
  bool ignored = false;  // the node has no effect; its first use in a text gives a warning
};

/// Reports whether the X3D type `name` with the bases `bases` is the type `wanted`, or derives from it.
[[nodiscard]] bool is_derived(std::string_view name, std::string_view bases, std::string_view wanted);

}  // namespace gs::vrml
