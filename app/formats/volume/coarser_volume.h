#pragma once

#include "qnv/sampling/volume/volume.h"

#include <cstdint>

namespace gs::app {

/// Returns a volume of every `step`-th voxel along each axis. Reads only every `step`-th slice. Components are kept,
/// steps of a time series are not.
[[nodiscard]] qnv::VolumeSource thinned(const qnv::VolumeSource& source, std::uint32_t step);

/// Returns the smallest step for which thinned() leaves at most `most` voxels; at least 1.
[[nodiscard]] std::uint32_t step_for_voxels(const qnv::VolumeLayout& layout, std::uint64_t most);

/// Adds a thinned version to a volume that takes long to read, unless it has coarser versions.
void add_coarser(qnv::VolumeSource& source);
inline constexpr std::uint64_t kLongVoxels = std::uint64_t{1} << 26;   // of volumes that take long to read
inline constexpr std::uint64_t kQuickVoxels = std::uint64_t{1} << 20;  // about those of the thinned version

}  // namespace gs::app
