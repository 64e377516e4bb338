#pragma once

#include "render/surface/patch_kernel.h"
#include "render/surface/patch_raster.h"
#include "render/surface/patch_screen.h"

namespace gs::render {

/// Prepares the triangles of a task's patches. The results are samples of small triangles, and large triangles, both
/// sorted by tile. Drops triangles without samples, and back faces of one-sided surfaces.
void prepare_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const PatchLens& lens,
                     const PatchGrid& grid, const PatchRasterOptions& options, const PatchLook& look,
                     const PatchKernel& kernel, PatchTask& task);

}  // namespace gs::render
