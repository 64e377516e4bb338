#pragma once

#include "qnv/sampling/volume/volume.h"

#include <cstdint>
#include <optional>
#include <utility>

namespace gs::qnv {

/// Decoded values of a volume, from which its vectors come. Any thread may read them at any time.
struct VolumeValues {
  VolumeSource source;                  // owns its data
  std::pair<float, float> range{0, 1};  // of the whole volume, which a prefix may exceed
  int level = 0;                        // voxels are 2^level voxels of the whole volume apart
  std::optional<float> error;           // maximum for every voxel, in the unit of the values; nullopt if it is unknown
  std::optional<float> wrong;           // labels: share of voxels with a wrong one, instead of `error`
  std::optional<float> rms;             // root mean square of the errors
  VoxelType stored = VoxelType::f32;    // of the original volume: value = stored * slope + intercept
  double slope = 1, intercept = 0;
  std::optional<double> missing;  // stored number that marks missing voxels
  bool exact = false;             // the stored voxels are restored bit for bit
  std::uint64_t bytes = 0;        // of memory
};

}  // namespace gs::qnv
