#pragma once

#include "app/base/read_file.h"
#include "app/formats/common/asset.h"
#include "base/budget.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

struct SplatModel;

/// Returns true for PlayCanvas SOG: splats as WebP images, in a ZIP archive or beside their meta.json.
[[nodiscard]] bool is_splats_sog(std::span<const std::byte> bytes);

/// Imports SOG, version 1 or 2. The axes are right, down, forward. Images beside meta.json are read with
/// `source.read_file`. Safe for untrusted input; memory is charged to the budget.
[[nodiscard]] Asset read_splats_sog(const ImportSource& source);

/// Reads a SOG into `model` from the text of its meta.json and the images that the text names. Returns a message on
/// failure. Safe for untrusted input; memory is charged to the budget.
[[nodiscard]] std::optional<std::string> read_sog_model(std::span<const std::byte> meta, const ReadFile& read,
                                                        const WorldBudget& budget, SplatModel& model);

/// Returns the names of the images that a meta.json lists, without those in other folders. Safe for untrusted text.
[[nodiscard]] std::vector<std::string> sog_files_of(std::span<const std::byte> meta);

/// Returns true for streamed SOG: lod-meta.json, which lists SOGs of several levels of detail.
[[nodiscard]] bool is_splats_sog_levels(std::span<const std::byte> bytes);

/// Imports streamed SOG. For each part of the scene, reads the finest level that fits into memory and is readable.
/// Reads only the files of these levels. Warns if finer levels are left out. Also reads the text of text_of_sog_parts().
/// Safe for untrusted input.
[[nodiscard]] Asset read_splats_sog_levels(const ImportSource& source);

}  // namespace gs::app
