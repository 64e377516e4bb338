#include "qnv/codecs/values/decode/level_layout.h"

#include "qnv/codecs/values/decode/values_decoder.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gs::qnv::values {

VolumeLayout level_layout(const ValueGrid& grid, const Description& about, int level) {
  VolumeLayout layout;
  layout.dimensions = low_extent(grid.dimensions, level);
  for (std::size_t a = 0; a < 3; ++a) {
    int steps = 0;
    while (steps < level && low_extent(grid.dimensions, steps)[a] > 1) ++steps;
    layout.axes[a] = grid.axes[a] * std::ldexp(1.0f, steps);
  }
  layout.origin = grid.origin;
  layout.base = about.origin;
  layout.metadata = about.metadata;
  layout.slope = grid.unit / level_gain(grid.dimensions, level);
  layout.intercept = grid.zero;
  layout.type = VoxelType::i32;
  layout.big_endian = std::endian::native == std::endian::big;
  return layout;
}

float smallest_step(const VolumeLayout& layout) {
  return std::min({glm::length(layout.axes[0]), glm::length(layout.axes[1]), glm::length(layout.axes[2])});
}

float largest_step(const VolumeLayout& layout) {
  return std::max({glm::length(layout.axes[0]), glm::length(layout.axes[1]), glm::length(layout.axes[2])});
}

}  // namespace gs::qnv::values
