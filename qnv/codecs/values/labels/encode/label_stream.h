#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/sampling/volume/volume.h"

#include <variant>

namespace gs::qnv {

/// Encodes a label volume without losses, coarse levels first; within a level, the runs that correct most voxels per
/// byte. Uses `max_bytes`, `parity`, `metadata`, `threads`, `spill`, `sink` and `ranks` of EncodeOptions. Reads the
/// volume once, slice by slice. Needs memory for three slices of 4 bytes per voxel, 100 MB for parts of the levels, and
/// the packed labels if `spill` keeps them in memory. Returns an error if the source or the spill fails, if numbers
/// have a fraction, for too many voxels or labels, or if cancelled. Blocks. Any thread. Safe for untrusted values.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_labels(const VolumeSource& source,
                                                                     const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
