#pragma once

#include "app/formats/common/upright.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/mesh.h"

#include <memory>
#include <vector>

namespace gs::app {

/// Returns the distance of the lines of a ground grid for a scene with these bounds. It is 1, 2 or 5 times a power of
/// ten, so that the scene is about ten squares wide. Returns 0 for empty bounds.
[[nodiscard]] double grid_spacing(const WideBox& bounds, const Upright& upright);

/// Makes the lines of a ground grid, at multiples of grid_spacing() in world space. Every tenth line is brighter.
/// Returns null for empty bounds.
[[nodiscard]] std::shared_ptr<const render::RenderList> ground_grid(const WideBox& bounds, const Upright& upright);

/// Cache of ground grids. If it is full, the oldest grid is replaced.
class GroundGrids {
 public:
  [[nodiscard]] std::shared_ptr<const render::RenderList> of(const WideBox& bounds, const Upright& upright);

 private:
  static constexpr std::size_t kMaxGrids = 8;
  struct Grid {
    WideBox bounds;
    Upright upright;
    std::shared_ptr<const render::RenderList> lines;
  };
  std::vector<Grid> grids_;  // newest last
};

}  // namespace gs::app
