#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/sampling/volume/volume.h"

#include <variant>

namespace gs::qnv {

/// Encodes a label volume without losses, coarse levels first; within a level, the runs that correct most voxels per
/// byte. Uses `max_bytes`, `parity`, `metadata`, `threads` and `sink` of EncodeOptions. Needs 5 bytes of memory per
/// voxel. Returns an error if the source fails, if numbers have a fraction, for too many voxels or labels, or if
/// cancelled. Blocks. Any thread. Safe for untrusted values.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_labels(const VolumeSource& source,
                                                                     const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
