#pragma once

#include "qnv/base/geometry.h"

#include <cstddef>

namespace gs::bench {

/// Gaussians as a SOG file of version 2 keeps them, and the size of that file.
struct SogPeer {
  std::size_t bytes = 0;
  qnv::Gaussians gaussians;
};

/// Quantises Gaussians like SOG: positions in 16 bits of log(1 + |x|), rotations in 8 bits a component, and tables of
/// 256 deviations and colours. The size is that of lossless WebP images in Morton order. Leaves out harmonics.
[[nodiscard]] SogPeer sog_of(const qnv::Gaussians& source);

}  // namespace gs::bench
