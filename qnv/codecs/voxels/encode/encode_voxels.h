#pragma once

#include "qnv/codecs/shared/encode_options.h"
#include "qnv/sampling/volume/volume.h"

#include <variant>

namespace gs::qnv {

/// Gradient vectors of a volume, and the lattice of the voxels that they come from (gradient_vectors).
struct VolumeVectors {
  const Volume& vectors;
  const VolumeLayout& layout;
};

/// Encodes the vectors of a volume as voxels. Uses `max_bytes`, `metadata` and `threads` of EncodeOptions.
/// Memory is proportional to the number of vectors. The bytes do not depend on the number of threads. Returns an error
/// if the vectors are not on the lattice, or if the lattice has more than 65536 voxels per axis.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_voxels(const VolumeVectors& volume,
                                                                     const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
