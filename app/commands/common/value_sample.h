#pragma once

#include "qnv/sampling/volume/volume.h"

#include <chrono>
#include <cstdint>
#include <limits>
#include <vector>

namespace gs::app {

/// Time for reading voxels.
struct ReadingTime {
  std::chrono::steady_clock::time_point deadline;
  bool is_given = false;  // by the user; then large volumes have as much time
};

/// Range of the values of the voxels that were read.
struct ValueSample {
  float least = std::numeric_limits<float>::infinity(), most = -least;
  std::uint64_t missing = 0, voxels = 0;  // of `voxels` read voxels, `missing` have no value
};

/// Returns the slices of a volume in the order in which they are read: those of a row of chunks together, and the rows
/// in an order that spreads any number of first rows over the volume (van der Corput).
[[nodiscard]] std::vector<std::uint32_t> spread_slices(std::uint32_t slices, std::uint32_t chunk);

/// Reads the values of a volume, slice by slice, until the deadline. Reads a very large volume for two seconds, unless
/// the user has given a time.
[[nodiscard]] ValueSample sample_values(const qnv::VolumeSource& volume, const ReadingTime& time);

}  // namespace gs::app
