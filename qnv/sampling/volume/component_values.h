#pragma once

#include "qnv/sampling/volume/volume_values.h"

#include <memory>
#include <span>

namespace gs::qnv {

/// Returns the lengths of the vectors of all components as float32 values, with their range. A voxel with a missing
/// component is missing. `all` is not empty; all have the same level and dimensions. Needs 4 bytes of memory per voxel.
/// Any thread.
[[nodiscard]] std::shared_ptr<const VolumeValues> magnitude_of(
    std::span<const std::shared_ptr<const VolumeValues>> all);

}  // namespace gs::qnv
