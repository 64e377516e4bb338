#pragma once

#include "app/formats/datasets/arrays/dataset_tree.h"
#include "app/formats/volume/volume_common.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Meaning of an axis of an array. Channels are axes of which one index is shown.
enum class AxisRole : std::uint8_t { x, y, z, time, component, channel };

/// Axis of an array, as the conventions of its file describe it.
struct GridAxis {
  AxisRole role = AxisRole::channel;
  std::string name{};
  double first = 0, step = 1;       // position of the first element, and to the next one
  std::vector<double> positions{};  // of all elements, if they are not evenly spaced; times of a time axis
};

/// Array to show as a volume, with the meaning of its axes and numbers.
struct GridSpec {
  /// Arrays of the same shape; several are the components of a vector.
  std::vector<std::size_t> arrays;
  std::vector<GridAxis> axes;             // of each axis of the arrays
  std::string path, title{}, unit{};      // for users
  double slope = 1, intercept = 0;        // value = stored * slope + intercept
  std::vector<double> missing{};          // stored numbers that mean "no data"
  std::optional<double> least{}, most{};  // valid range of stored numbers
  bool reads_unsigned = false;            // signed integers are meant as unsigned ones
  bool labels = false;
  bool colors = false;       // components may be colours
  glm::dmat3 directions{1};  // columns: unit vectors of the axes x, y and z
  std::vector<std::pair<std::string, std::string>> metadata{};
};

/// Creates a volume that reads the array slice by slice. `choice` selects a step, a channel and a component. Unevenly
/// spaced values are interpolated to even distances, labels and integers by the nearest one. Decoded parts are kept
/// within the budget. Returns a message on failure.
[[nodiscard]] VolumeResult open_grid(const DatasetTree& tree, GridSpec spec, const VoxelComponent& choice);

/// Returns true if all distances are equal within a tolerance for rounded numbers.
[[nodiscard]] bool is_even(std::span<const double> positions);

}  // namespace gs::app
