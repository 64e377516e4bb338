#pragma once

#include "qnv/sampling/volume/volume.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace gs::qnv {

/// Choice of the number to show of voxels that have several.
struct ShownComponent {
  std::uint32_t index = 0;  // from 0; the last one if it is too large
  bool magnitude = false;   // the length of the vector of all numbers instead
};

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
  std::optional<double> missing;                                  // stored number that marks missing voxels
  bool exact = false;                                             // the stored voxels are restored bit for bit
  std::uint64_t bytes = 0;                                        // of memory
  std::vector<std::shared_ptr<const VolumeValues>> components{};  // all numbers of a voxel, if it has several
};

}  // namespace gs::qnv
