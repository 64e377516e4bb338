#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/sampling/volume/volume.h"

#include <variant>

namespace gs::qnv {

/// Encodes the values of a volume. Uses `max_bytes`, `tolerance`, `metadata` and `threads` of EncodeOptions. Needs
/// about 26 bytes of memory per voxel. The bytes do not depend on the number of threads. Returns an error if the source
/// fails, for a volume without values or with too many voxels, or if cancelled. Blocks. Any thread. Safe for untrusted
/// values.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_values(const VolumeSource& source,
                                                                     const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
