#pragma once

#include "app/confined/data_child.h"
#include "app/formats/volume/volume.h"

#include <cstddef>
#include <memory>
#include <string>
#include <variant>

namespace gs::app {

/// Opens a volume as open_volume() does, but in a confined child process (app/confined) that reads its slices. The
/// child gets the open file and those that the header names, and has no other rights. It works ahead of readers. If it
/// ends or gives no answer, slices cannot be read. Processes without children (DecoderPool) open the volume themselves.
/// Waits for slices end when `budget` is stopped.
[[nodiscard]] std::variant<qnv::VolumeSource, std::string> open_volume_confined(
    const std::string& path, const RawVolume& raw = {}, const VolumeOrigin& origin = {},
    const WorldBudget& budget = own_budget());

/// Number of volumes that have a child at a time. The child of the volume that was read least recently ends, and starts
/// again when a slice is read.
inline constexpr std::size_t kMostVolumeChildren = 8;

/// Returns the volume of a child: a MakeOpenData. Requests are those of volume_transfer.h.
[[nodiscard]] std::unique_ptr<OpenData> volume_of_child();

}  // namespace gs::app
