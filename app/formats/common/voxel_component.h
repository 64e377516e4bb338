#pragma once

#include "qnv/sampling/volume/volume_values.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

struct DatasetList;

/// Colours of the values on surfaces.
struct SurfaceColors {
  enum class Range : std::uint8_t {
    whole,     // from the minimum to the maximum value
    contrast,  // without the lowest and the highest 2 % of the values
    typed,     // from `low` to `high`
  };
  Range range = Range::whole;
  double low = 0, high = 1;
  std::vector<glm::vec3> map{};  // evenly spaced sRGB colours from the lowest value on; empty means Viridis
  friend bool operator==(const SurfaceColors&, const SurfaceColors&) = default;
};

/// Form in which the vectors of a volume are drawn.
enum class FlowForm : std::uint8_t {
  values,  // one component or the magnitude, as a volume
  arrows,
  streamlines,
};

/// Time of a step that means the newest one.
inline constexpr double kNewestStep = std::numeric_limits<double>::max();

/// Values to read from a file that has several: of a dataset, a step and a channel, the number of each voxel.
struct VoxelComponent {
  std::uint32_t index = 0;
  bool chosen = false;                   // the user chose this number; otherwise encoders keep all numbers
  bool magnitude = false;                // the length of the vector of all components instead
  std::optional<qnv::ShownStep> step{};  // of a time series; nullopt means all for encoders, else the first
  std::optional<bool> labels{};          // the numbers are labels of a segmentation; nullopt means as the file states
  std::string folder{};                  // folder or URL with all files of a scan; empty means a single file
  std::string dataset{};                 // of a file that has several; empty means the largest one
  std::optional<std::uint64_t> channel{};  // index on the axes that are neither space nor time nor components
  std::optional<bool> globe{};  // longitudes and latitudes on a sphere; nullopt: only meshes of the whole globe
  bool growing = false;         // another program may write to the file meanwhile; what is there now is read
  FlowForm flow = FlowForm::values;  // of volumes with two or three components
  SurfaceColors colors{};
  std::shared_ptr<DatasetList> found{};  // readers write the datasets of the file here; null if they are not needed
  bool served = false;   // the file is on a server
  bool by_view = false;  // views read parts of large arrays, so the finest level of an image is the default
  friend bool operator==(const VoxelComponent&, const VoxelComponent&) = default;
};

}  // namespace gs::app
