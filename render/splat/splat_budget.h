#pragma once

#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"
#include "render/splat/software/splat_raster.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace gs::render {

/// Camera of a viewport, for the importance of splat items.
struct BudgetView {
  glm::dmat4 camera_from_world{1.0};
  glm::vec2 tangents{1.0f};  // tangents of half the angles of view, horizontal and vertical
  int width = 0, height = 0;
  glm::vec2 center{0.0f};  // tangents of the image centre
};

/// Returns the view of a viewport, with one sample per pixel. The caller sets `camera_from_node`.
[[nodiscard]] SplatView viewport_view(const Camera& camera, const Projection& projection, const DrawOptions& options);
/// Returns the view of the whole image. `view` is a tile of it, as `camera` describes.
[[nodiscard]] SplatView whole_view(SplatView view, const Camera& camera);
[[nodiscard]] BudgetView budget_view(const SplatView& view, const glm::dmat4& camera_from_world);

/// Distributes `budget` vectors over all surfaces and volumes. An item's weight is the pixels that its box covers,
/// times its `detail`; each item gets a minimum. Unused shares go to other items. But an item with a detail below 1
/// uses at most that share of the budget.
///
/// If `budget` is 0 (unlimited), returns 0 for each item. Otherwise returns at least 1 each. Accepts any numbers.
[[nodiscard]] std::vector<std::size_t> share_budget(std::span<const SplatItem> items, const BudgetView& view,
                                                    std::size_t budget);

/// Estimates the pixels that the bounding sphere of an item's box covers. Returns 0 if it is out of view.
[[nodiscard]] double pixels_covered(const SplatItem& item, const BudgetView& view);

}  // namespace gs::render
