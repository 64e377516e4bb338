#pragma once

#include "app/formats/datasets/arrays/array_file.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Returns true if a file begins like NetCDF in a classic format: CDF-1, CDF-2 (64-bit offsets) or CDF-5 (64-bit data).
[[nodiscard]] bool is_classic_netcdf(std::span<const std::byte> bytes);

/// Opens a NetCDF file in a classic format. Reads only its header; values are read from `bytes` without copies of the
/// whole. Returns a message on failure. Safe for untrusted files.
[[nodiscard]] ArrayFileResult open_classic_netcdf(ArrayBytes bytes);

}  // namespace gs::app
