#pragma once

#include "app/formats/common/asset.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Returns true for RAD (Spark).
[[nodiscard]] bool is_splats_rad(std::span<const std::byte> bytes);

/// Imports RAD version 1: the leaves of its tree of levels of detail. If the file is truncated or exceeds memory,
/// coarser splats replace the missing ones. Reads chunks in other files with `source.read_file`. The axes are right,
/// down, forward. Safe for untrusted input; memory is charged to the budget.
[[nodiscard]] Asset read_splats_rad(const ImportSource& source);

}  // namespace gs::app
