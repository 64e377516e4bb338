#pragma once

#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"
#include "render/splat/splat_raster.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace gs::render {

/// Camera of a viewport, as far as it determines the importance of point sets.
struct BudgetView {
  glm::dmat4 camera_from_world{1.0};
  glm::vec2 tangents{1.0f};  // of the half angles of view, horizontally and vertically
  int width = 0, height = 0;
  glm::vec2 center{0.0f};  // tangents of the image centre
};

/// Returns the view of a viewport, with one sample per pixel. The caller sets `camera_from_node`.
[[nodiscard]] SplatView viewport_view(const Camera& camera, const Projection& projection, const DrawOptions& options);
/// Returns the full-image view of which `view` is a tile, according to `camera`.
[[nodiscard]] SplatView whole_view(SplatView view, const Camera& camera);
[[nodiscard]] BudgetView budget_view(const SplatView& view, const glm::dmat4& camera_from_world);

/// Distributes `budget` vectors over all items, surfaces and volumes: by the pixels that an item's box covers, times
/// its `detail`, plus a minimum for each. Unused shares go to other items, but an item with a detail below 1 leaves its
/// share unused. Returns 0 (unlimited) for each if `budget` is 0, else at least 1. Accepts any numbers.
[[nodiscard]] std::vector<std::size_t> share_budget(std::span<const SplatItem> items, const BudgetView& view,
                                                    std::size_t budget);

/// Estimates the pixels of an item's box from its bounding sphere; 0 if it is out of view.
[[nodiscard]] double pixels_covered(const SplatItem& item, const BudgetView& view);

}  // namespace gs::render
