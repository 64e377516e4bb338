#pragma once

#include "app/formats/common/upright.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/mesh.h"

#include <memory>
#include <vector>

namespace gs::app {

/// Returns the line spacing of a ground grid for a scene of size `bounds`: 1, 2 or 5 times a power of ten, so that the
/// scene spans about ten squares. Returns 0 for empty bounds.
[[nodiscard]] double grid_spacing(const WideBox& bounds, const Upright& upright);

/// Builds ground lines at multiples of `grid_spacing` in world space; every tenth line is brighter. Returns null for
/// empty bounds.
[[nodiscard]] std::shared_ptr<const render::RenderList> ground_grid(const WideBox& bounds, const Upright& upright);

/// Cache of the most recently used grids.
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
