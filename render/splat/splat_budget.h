#pragma once

#include "render/scene/camera.h"
#include "render/scene/render_list.h"
#include "render/splat/splat_raster.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace gs::render {

/// The eye of a viewport, as far as it decides which clouds matter.
struct BudgetView {
  glm::dmat4 camera_from_world{1.0};
  glm::vec2 tangents{1.0f};  // of half the angles of view, horizontally and vertically
  int width = 0, height = 0;
  glm::vec2 center{0.0f};  // tangents of what is in the middle
};

/// The view of the picture that `view` has a part of, as `camera` says.
[[nodiscard]] SplatView whole_view(SplatView view, const Camera& camera);
[[nodiscard]] BudgetView budget_view(const SplatView& view, const glm::dmat4& camera_from_world);

/// How many vectors of each item, surfaces and volumes alike, may be drawn, so that they are `budget` together: by the
/// pixels that its box covers, times its `detail`, and some for each. What an item cannot use goes to the others; an
/// item with a detail below 1 leaves its part of the whole budget unused. 0: no limit, where `budget` is 0; else at
/// least 1. Safe for any numbers.
[[nodiscard]] std::vector<std::size_t> share_budget(std::span<const SplatItem> items, const BudgetView& view,
                                                    std::size_t budget);

/// The pixels that an item's box may cover, told from the ball around it; 0 when it is out of view.
[[nodiscard]] double pixels_covered(const SplatItem& item, const BudgetView& view);

}  // namespace gs::render
