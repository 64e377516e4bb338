#pragma once

#include "qnv/base/geometry.h"

#include <cstddef>
#include <string>
#include <vector>

namespace gs::bench {

/// Gaussians as a SOG file of version 2 keeps them, and the size of that file.
struct SogPeer {
  std::size_t bytes = 0;
  qnv::Gaussians gaussians;
};

/// Exports Gaussians as SOG, and reads the file. Both parts are empty on failure.
[[nodiscard]] SogPeer sog_of(const qnv::Gaussians& source);

/// Reads the levels of a streamed SOG from the folder of its lod-meta.json, the coarsest first. The bytes of a
/// level are those of lod-meta.json and of the files of the coarsest level and of this level.
[[nodiscard]] std::vector<SogPeer> sog_levels_of(const std::string& folder);

}  // namespace gs::bench
