#pragma once

#include "app/formats/common/dataset_list.h"
#include "app/formats/common/voxel_component.h"
#include "app/session/live/live_control.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Datasets of the file in the active viewport, and the current choice.
struct UiData {
  std::shared_ptr<const DatasetList> list;  // null if no file is shown; without entries for files of one dataset
  VoxelComponent choice;                    // of the user; the datasets of `choice.found` are not used
  bool is_mesh = false;                     // the values colour a surface
  std::pair<double, double> range{0, 1};    // values of its first and last colour
  bool loading = false;                     // other data are being read
  std::vector<std::string> over;            // names of the contents over the viewport
  bool can_follow = false, followed = false, newest = false;
  const LiveState* live = nullptr;  // simulation that the viewport shows, or null
};

/// Requests of the user for data in this frame.
struct UiDataActions {
  std::optional<VoxelComponent> choose, beside, over;  // data of the file in the active viewport
  std::optional<std::size_t> file_beside, file_over;   // indices in UiModel::files
  std::optional<std::size_t> remove_over;              // index in UiData::over
  std::optional<bool> follow, newest;
  std::optional<std::string> live, live_token;  // requested change, as for LiveControl::change(), and token
};

/// Returns `choice` with another dataset of the same file. Keeps the step and the colour map.
[[nodiscard]] VoxelComponent with_dataset(const VoxelComponent& choice, const std::string& path);

}  // namespace gs::app
