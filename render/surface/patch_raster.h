#pragma once

#include "qnv/codecs/displaced/tessellation/surface_cut.h"
#include "render/scene/cloud_look.h"
#include "render/splat/splat_raster.h"

#include <cstddef>

namespace gs::render {

/// Options of rasterizing a displaced surface.
struct PatchRasterOptions {
  bool two_sided = false;
  qnv::Rgb8 color;  // of parts without own colours, if others have some
  ColorBy color_by = ColorBy::own;
};

/// Rasterizes the triangles of a cut on the CPU: the nearest surface of every sample with its interpolated normal,
/// averaged over the samples of each pixel. Leaves no gaps on shared edges. Clips triangles at the near plane. Gives
/// the same bits for any number of threads. `layer.discs` is the number of drawn vertices; `layer.drawn` that of
/// triangles that may cover samples.
[[nodiscard]] SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut,
                                           const SplatView& view, const PatchRasterOptions& options);

}  // namespace gs::render
