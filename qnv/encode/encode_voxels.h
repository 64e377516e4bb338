#pragma once

#include "qnv/encode/encode_surface.h"
#include "qnv/volume/volume.h"

#include <variant>

namespace gs::qnv {

/// The gradient vectors of a volume, and the layout of its voxels, at whose centres they stand (gradient_vectors).
struct VolumeVectors {
  const Cloud& cloud;
  const VolumeLayout& layout;
};

/// Encodes the vectors of a volume as voxels. Of EncodeOptions `max_bytes`, `compact`, `metadata` and `threads` count.
/// Memory grows with the vectors. The same bytes for the same input and options, whatever the threads. An error where
/// the vectors do not stand on the lattice, or the lattice has more than 65536 voxels an axis.
[[nodiscard]] std::variant<EncodedStream, EncodeError> encode_voxels(const VolumeVectors& volume,
                                                                     const EncodeOptions& options,
                                                                     Progress* progress = nullptr);

}  // namespace gs::qnv
