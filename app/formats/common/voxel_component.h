#pragma once

#include <cstdint>

namespace gs::app {

/// Number to read from voxels that have several: colours or vectors.
struct VoxelComponent {
  std::uint32_t index = 0;
  bool magnitude = false;  // the length of the vector of all components instead
  friend bool operator==(const VoxelComponent&, const VoxelComponent&) = default;
};

}  // namespace gs::app
