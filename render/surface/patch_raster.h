#pragma once

#include "qnv/codecs/displaced/tessellation/surface_cut.h"
#include "render/scene/splat_style.h"
#include "render/splat/software/splat_raster.h"

#include <cstddef>

namespace gs::render {

/// Options for rasterizing a displaced surface.
struct PatchRasterOptions {
  bool two_sided = false;
  qnv::Rgb8 color;  // colour of parts without own colours, if other parts have colours
  ColorBy color_by = ColorBy::own;
};

/// Rasterizes the triangles of a cut on the CPU. Finds the nearest surface at each sample, with its interpolated
/// normal, and averages the samples of each pixel. Clips triangles at the near plane. Shared edges have no gaps. Gives
/// identical bits for any number of threads.
///
/// `layer.discs` is the number of drawn vertices. `layer.drawn` is the number of triangles that may cover samples.
[[nodiscard]] SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut,
                                           const SplatView& view, const PatchRasterOptions& options);

}  // namespace gs::render
