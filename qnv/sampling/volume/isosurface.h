#pragma once

#include "qnv/base/triangles.h"
#include "qnv/sampling/volume/volume.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <cstdint>
#include <optional>

namespace gs::qnv {

/// Options of an isosurface.
struct IsosurfaceOptions {
  double isovalue = 0;  // in the unit of the volume's values
  Rgb8 color{};  // colour of all corners
  unsigned threads = 0;  // 0 means one per core
};

/// Extracts the surface between values >= isovalue and lower values by marching cubes (Lorensen and Cline 1987), in
/// world units. Passes its triangles to `sink`.
/// A bilinear saddle test decides faces with two diagonal corners inside (Nielson and Hamann 1991). Both cells at such
/// a face decide alike, so the surface has no cracks. It is open at the border of the volume and at missing voxels.
/// Triangles are counter-clockwise seen from lower values. Normals come from the gradient and point to lower values;
/// without a gradient they are zero. Triangles with two equal corners are dropped.
/// The calling thread passes triangles in batches, in the order of their cells, independent of the number of threads.
/// Needs memory for a few slices and one batch. Returns nullopt on success, or if the sink returned false. Returns an
/// error for an invalid layout, for an isovalue that is not finite, if the source fails, or if cancelled. Progress
/// counts slices. Any thread. Safe for untrusted values.
[[nodiscard]] std::optional<VolumeError> isosurface(const VolumeSource& source, const IsosurfaceOptions& options,
                                                    const TriangleSink& sink, Progress* progress = nullptr);

}  // namespace gs::qnv
