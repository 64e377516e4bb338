#pragma once

#include "app/formats/datasets/arrays/array_file.h"

namespace gs::app {

/// Opens an HDF5 file, including NetCDF-4.
[[nodiscard]] ArrayFileResult open_hdf5_arrays(ArrayBytes bytes, std::size_t cache_bytes);

}  // namespace gs::app
