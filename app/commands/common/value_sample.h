#pragma once

#include "qnv/sampling/volume/volume.h"

#include <chrono>
#include <cstdint>
#include <limits>
#include <vector>

namespace gs::app {

/// Time limit for reading voxels.
struct ReadingTime {
  std::chrono::steady_clock::time_point deadline;
  bool is_given = false;  // the user set it; otherwise large volumes get two seconds
};

/// Range of the values of the voxels that were read.
struct ValueSample {
  float least = std::numeric_limits<float>::infinity(), most = -least;
  std::uint64_t missing = 0, voxels = 0;  // of `voxels` read voxels, `missing` have no value
};

/// Returns the slices of a volume in reading order. Slices of a row of chunks stay together. The rows are in van der
/// Corput order, so that even the first few rows are spread over the volume.
[[nodiscard]] std::vector<std::uint32_t> spread_slices(std::uint32_t slices, std::uint32_t chunk);

/// Reads the values of a volume, slice by slice, until the deadline. Reads a very large volume for at most two seconds,
/// unless the user has given a time.
[[nodiscard]] ValueSample sample_values(const qnv::VolumeSource& volume, const ReadingTime& time);

}  // namespace gs::app
