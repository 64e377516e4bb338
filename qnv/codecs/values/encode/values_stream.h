#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/sampling/volume/volume.h"

#include <variant>

namespace gs::qnv {

/// Encodes the values of a volume. Uses `max_bytes`, `tolerance`, `metadata`, `threads`, `spill` and `sink` of
/// EncodeOptions. Reads the volume several times, slice by slice. Needs memory for about 60 slices of 4 bytes per
/// voxel, 100 bytes per cluster, and the clusters if `spill` keeps them in memory. The bytes depend neither on threads
/// nor on `spill`. Returns an error if the source or the spill fails, for a volume without values or with too many
/// voxels, or if cancelled. Blocks. Any thread. Safe for untrusted values.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_values(const VolumeSource& source,
                                                                     const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
