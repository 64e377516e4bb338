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

// Where a node is in the picture.
namespace gs::app {

/// World space: all that a list shows of the first of these nodes of which it shows anything, with all its USEs.
/// Empty: it shows nothing of them. Takes time in proportion to the list.
[[nodiscard]] render::WorldBounds bounds_in(const render::RenderList& list, std::span<const NodeAt> nodes);

/// A line from one framebuffer pixel to another.
using PixelLine = std::pair<glm::vec2, glm::vec2>;
/// The edges of a box as one who looks sees them in a viewport, as far as they lie before him; they may leave it.
[[nodiscard]] std::vector<PixelLine> edges_of(const render::WorldBounds& box, const Pose& pose,
                                              const Viewport& viewport);

}  // namespace gs::app
