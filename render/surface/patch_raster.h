#pragma once

#include "qnv/surface/surface_cut.h"
#include "render/scene/cloud_look.h"
#include "render/splat/splat_raster.h"

#include <cstddef>

namespace gs::render {

/// What of a surface is rasterised, and how.
struct PatchRasterOptions {
  bool two_sided = false;
  qnv::Rgb8 color;  // of parts without colours of their own, where others have some
  ColorBy color_by = ColorBy::own;
};

/// The triangles of a cut on the processor: the nearest surface of every sample, its normal between those of the
/// corners, averaged over the samples of each pixel. No sample on an edge between two triangles is left out. Triangles
/// that reach behind the near plane are cut there. The same bits whatever the number of threads. `layer.discs`: the
/// vertices of what was drawn; `layer.drawn`: triangles that may cover some sample.
[[nodiscard]] SplatLayer rasterize_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut,
                                           const SplatView& view, const PatchRasterOptions& options);

}  // namespace gs::render
