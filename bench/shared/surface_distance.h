#pragma once

#include "bench/shared/mesh_files.h"
#include "qnv/base/geometry.h"

namespace gs::bench {

/// Distance between two surfaces, relative to the diagonal of the first surface's box. Points are spread over both
/// surfaces by area. The larger of the two directed distances counts (P. Cignoni et al., "Metro", 1998).
struct SurfaceDistance {
  double root_mean_square = 0, mean = 0, most = 0;
  /// Returns 20 log10 of the diagonal over the root mean square in dB, as in papers on geometry compression.
  [[nodiscard]] double psnr() const;
};

/// Measures the distance. Deterministic; both meshes must have triangles.
[[nodiscard]] SurfaceDistance surface_distance(const Mesh& original, const Mesh& other);

/// Returns the triangles of a decoded surface.
[[nodiscard]] Mesh mesh_of(const qnv::IndexedMesh& surface);

}  // namespace gs::bench
