#pragma once

#include "vrml/scene/node_type.h"

#include <string_view>

namespace gs::vrml::x3d {

/// Returns the default field of the parent for nodes of a type (`containerField` of ISO/IEC 19776-1). For PROTOs, the
/// first node of the body decides. Returns an empty text if it is unknown.
[[nodiscard]] std::string_view default_container(const NodeType& type);

/// Returns the field of `parent` that takes a node of `type`: `container` if it is set and fits, then the default
/// field, then the only field that accepts the type, then `children`. `type` may be null. Returns null if there is
/// none.
[[nodiscard]] const InterfaceDeclaration* place_of(const NodeType& parent, const NodeType* type,
                                                   std::string_view container);

}  // namespace gs::vrml::x3d
