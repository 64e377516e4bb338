#pragma once

#include "app/formats/common/asset.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Returns true for PlayCanvas SOG: splats as WebP images, in a ZIP archive or beside their meta.json.
[[nodiscard]] bool is_splats_sog(std::span<const std::byte> bytes);

/// Imports SOG, version 1 or 2. The axes are right, down, forward. Images beside meta.json are read with
/// `source.read_file`. Safe for untrusted input; memory is charged to the budget.
[[nodiscard]] Asset read_splats_sog(const ImportSource& source);

}  // namespace gs::app
