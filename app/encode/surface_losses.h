#pragma once

#include "render/scene/render_list.h"

#include <string>
#include <vector>

namespace gs::app {

/// Returns the properties of a scene that its triangles do not keep, as messages for the user: transparency, light from
/// materials, lines, points, vectors, lights, Viewpoints and sounds.
[[nodiscard]] std::vector<std::string> surface_losses(const render::RenderList& list);

}  // namespace gs::app
