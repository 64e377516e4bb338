#pragma once

#include "app/formats/common/upright.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/mesh.h"

#include <memory>
#include <vector>

namespace gs::app {

/// How far apart the lines of a grid are on the ground under things that fill `bounds`: 1, 2 or 5 times a power of ten,
/// so that they stand on some ten of its squares; 0 where there is nothing.
[[nodiscard]] double grid_spacing(const render::WorldBounds& bounds, const Upright& upright);

/// Lines on the ground under things, at multiples of `grid_spacing`, every tenth of them brighter; null where there is
/// nothing. World space.
[[nodiscard]] std::shared_ptr<const render::RenderList> ground_grid(const render::WorldBounds& bounds, const Upright& upright);

/// The grids that were asked for last.
class GroundGrids {
 public:
  [[nodiscard]] std::shared_ptr<const render::RenderList> of(const render::WorldBounds& bounds, const Upright& upright);

 private:
  static constexpr std::size_t kMostGrids = 8;
  struct Grid {
    render::WorldBounds bounds;
    Upright upright;
    std::shared_ptr<const render::RenderList> lines;
  };
  std::vector<Grid> grids_;  // the newest last
};

}  // namespace gs::app
