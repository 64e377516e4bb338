#pragma once

#include "vrml/scene/node_type.h"

namespace gs::vrml {

/// Returns the node of VRML97 that is written for nodes of an X3D type; null if they are left out.
[[nodiscard]] const Vrml97Equivalent* vrml97_equivalent(const NodeType& type);

}  // namespace gs::vrml
