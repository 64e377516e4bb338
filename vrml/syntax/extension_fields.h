#pragma once

#include "vrml/scene/node_type.h"

#include <string_view>

namespace gs::vrml {

/// Reports whether other browsers have an interface of this name in a built-in type, but the standards do not: fields
/// of Castle Game Engine, X_ITE and InstantReality. Also knows the names of its events, `set_x` and `x_changed`.
[[nodiscard]] bool is_extension_field(const NodeType& type, std::string_view name);

}  // namespace gs::vrml
