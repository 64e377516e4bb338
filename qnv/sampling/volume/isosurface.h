#pragma once

#include "qnv/base/triangles.h"
#include "qnv/sampling/volume/volume.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <cstdint>
#include <optional>

namespace gs::qnv {

/// Options of an isosurface.
struct IsosurfaceOptions {
  double isovalue = 0;   // in the volume's values
  Rgb8 color{};          // of every corner
  unsigned threads = 0;  // 0: one per core
};

/// Extracts the surface between values >= isovalue and lower ones by marching cubes (Lorensen and Cline 1987), in world
/// units. A bilinear saddle test decides faces with two diagonal corners inside (Nielson and Hamann 1991). Both cells
/// at such a face decide alike, so the surface has no cracks. It is open at the volume's border and at missing voxels.
/// Triangles are counter-clockwise seen from lower values. Normals come from the gradient and point to lower values;
/// they are zero if there is no gradient. Triangles with two equal corners are dropped. The calling thread delivers
/// triangles in batches, in the order of their cells, independent of the number of threads. Needs memory for a few
/// slices and one batch. Returns nullopt on success, or if the sink requested no more. Returns an error for an invalid
/// layout, an isovalue that is not finite, a source that fails, or if cancelled. Progress counts slices. Safe from any
/// thread and for untrusted values.
[[nodiscard]] std::optional<VolumeError> isosurface(const VolumeSource& source, const IsosurfaceOptions& options,
                                                    const TriangleSink& sink, Progress* progress = nullptr);

}  // namespace gs::qnv
