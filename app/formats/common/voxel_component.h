#pragma once

#include "qnv/sampling/volume/volume_values.h"

#include <cstdint>
#include <optional>

namespace gs::app {

/// Number to read from voxels that have several, such as colours or vectors, and its meaning.
struct VoxelComponent {
  std::uint32_t index = 0;
  bool chosen = false;                   // the user chose this number; otherwise encoders keep all numbers
  bool magnitude = false;                // the length of the vector of all components instead
  std::optional<qnv::ShownStep> step{};  // of a time series; nullopt means all for encoders, else the first
  std::optional<bool> labels{};          // the numbers are labels of a segmentation; nullopt means as the file states
  friend bool operator==(const VoxelComponent&, const VoxelComponent&) = default;
};

}  // namespace gs::app
