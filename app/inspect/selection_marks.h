#pragma once

#include "app/inspect/node_children.h"
#include "app/view/navigation.h"
#include "app/view/viewports.h"
#include "render/scene/render_list.h"

#include <glm/vec2.hpp>

#include <array>
#include <span>
#include <utility>
#include <vector>

// Position of a node in the picture.
namespace gs::app {

/// Returns the world-space bounds of the first of `nodes` that is visible in a list, with all its USEs. Empty if none
/// is visible. The time is proportional to the list.
[[nodiscard]] render::WorldBounds bounds_in(const render::RenderList& list, std::span<const NodeAt> nodes);

/// Line between two framebuffer pixels.
using PixelLine = std::pair<glm::vec2, glm::vec2>;
/// Projects the edges of a box into a viewport. Clips them to the front of the viewer, not to the viewport.
[[nodiscard]] std::vector<PixelLine> edges_of(const render::WorldBounds& box, const Pose& pose,
                                              const Viewport& viewport);

}  // namespace gs::app
