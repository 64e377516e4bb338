#pragma once

#include "app/formats/common/time_steps.h"
#include "app/formats/common/voxel_component.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace gs::app {

/// Step of a series in JSON (`.series`) that names files of any format, one per step.
struct SeriesStep {
  std::string file;  // reference to the file of the step, as written
  TimeSteps steps;   // times of all steps, and the number of this one
};

/// Reports whether the first bytes of a file are those of a series in JSON.
[[nodiscard]] bool is_file_series(std::span<const std::byte> first);

/// Returns the wanted step of a series, or the first step if `wanted` is nullopt. Sorts the steps by time. Returns
/// nullopt if the bytes are not a valid series. Returns nullopt also for files of VTK, because the reader of VTK reads
/// such a series as a whole. Safe for untrusted bytes.
[[nodiscard]] std::optional<SeriesStep> step_of_series(std::span<const std::byte> bytes,
                                                       const std::optional<qnv::ShownStep>& wanted);

}  // namespace gs::app
