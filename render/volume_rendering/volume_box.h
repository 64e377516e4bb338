#pragma once

#include "vrml/mesh/mesh.h"

#include <memory>

namespace gs::render {

/// Returns the box from -0.5 to 0.5, which all items with a volume share as their mesh. Any thread.
[[nodiscard]] std::shared_ptr<const vrml::Mesh> volume_box();

}  // namespace gs::render
