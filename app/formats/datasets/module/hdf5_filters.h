#pragma once

namespace gs::app {

/// Registers decoders of filters that are not part of HDF5: LZF, Blosc, LZ4 and Zstandard. They cannot encode.
void register_hdf5_filters();

}  // namespace gs::app
