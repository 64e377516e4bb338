#pragma once

#include "qnv/base/description.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/volume.h"

namespace gs::qnv::values {

/// Returns the layout of the samples of a level, as i32 numbers. Level n has voxels 2^n voxels of the volume apart; an
/// axis of one voxel stays as it is.
[[nodiscard]] VolumeLayout level_layout(const ValueGrid& grid, const Description& about, int level);

/// Returns the smallest and the largest distance of neighbours on an axis.
[[nodiscard]] float smallest_step(const VolumeLayout& layout);
[[nodiscard]] float largest_step(const VolumeLayout& layout);

}  // namespace gs::qnv::values
