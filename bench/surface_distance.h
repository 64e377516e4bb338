#pragma once

#include "bench/mesh_files.h"
#include "qnv/base/cloud.h"

namespace gs::bench {

/// How far two surfaces are from one another, as parts of the diagonal of the box of the first; places are spread over
/// both by area, and of the two directions the larger figure counts (as P. Cignoni et al., "Metro", 1998, has it).
struct SurfaceDistance {
  double root_mean_square = 0, mean = 0, most = 0;
  /// 20 log10 of the diagonal over the root mean square, dB: what papers on compression of geometry give.
  [[nodiscard]] double psnr() const;
};

/// Deterministic; both must have triangles.
[[nodiscard]] SurfaceDistance surface_distance(const Mesh& original, const Mesh& other);

/// The triangles of a decoded surface.
[[nodiscard]] Mesh mesh_of(const qnv::Cloud& cloud);

}  // namespace gs::bench
