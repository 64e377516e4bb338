#pragma once

#include "qnv/sampling/volume/volume_values.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gs::app {

/// Values to read from a file that has several: of a dataset, a step and a channel, the number of each voxel.
struct VoxelComponent {
  std::uint32_t index = 0;
  bool chosen = false;                   // the user chose this number; otherwise encoders keep all numbers
  bool magnitude = false;                // the length of the vector of all components instead
  std::optional<qnv::ShownStep> step{};  // of a time series; nullopt means all for encoders, else the first
  std::optional<bool> labels{};          // the numbers are labels of a segmentation; nullopt means as the file states
  std::string folder{};                  // local folder with all files of a scan; empty means a single file
  std::string dataset{};                 // of a file that has several; empty means the largest one
  std::optional<std::uint64_t> channel{};  // index on the axes that are neither space nor time nor components
  std::optional<bool> globe{};  // longitudes and latitudes on a sphere; nullopt: only meshes of the whole globe
  bool by_view = false;  // views read parts of large arrays, so the finest level of an image is the default
  friend bool operator==(const VoxelComponent&, const VoxelComponent&) = default;
};

}  // namespace gs::app
