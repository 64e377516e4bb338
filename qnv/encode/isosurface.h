#pragma once

#include "qnv/base/triangles.h"
#include "qnv/volume/volume.h"
#include "qnv/volume/volume_slices.h"

#include <cstdint>
#include <optional>

namespace gs::qnv {

/// Which surface of a volume, and how it is made.
struct IsosurfaceOptions {
  double isovalue = 0;   // in the volume's values
  Rgb8 color{};          // of every corner
  unsigned threads = 0;  // 0: one a core
};

/// The surface that parts values >= isovalue from lower ones, by marching cubes (Lorensen and Cline 1987): in each
/// cell of eight voxels triangles between points of its edges, in world units. Faces with two diagonal
/// corners inside are decided by their bilinear saddle (Nielson and Hamann 1991), which both cells at the face see
/// alike: the surface has no cracks. It is open where it meets the volume's border or missing voxels.
///
/// Triangles are counter-clockwise seen from lower values; normals come from the gradient and point to lower values,
/// zero where there is no gradient. Triangles with two equal corners are left out. They come in the
/// order of their cells, in batches, from the calling thread: the same for every number of threads, in
/// memory for a few slices and one batch.
///
/// Nothing when it worked, or the sink wanted no more. Errors: an unsound layout, an isovalue that is not finite, a
/// source that cannot be read, cancelled. Progress counts slices. Any thread; safe for untrusted values.
[[nodiscard]] std::optional<VolumeError> isosurface(const VolumeSource& source, const IsosurfaceOptions& options,
                                                    const TriangleSink& sink, Progress* progress = nullptr);

}  // namespace gs::qnv
