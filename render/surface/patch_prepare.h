#pragma once

#include "render/surface/patch_kernel.h"
#include "render/surface/patch_raster.h"
#include "render/surface/patch_screen.h"

namespace gs::render {

/// The triangles of the patches of a task: samples of small ones, and large ones, both sorted by tile. Those that cover
/// no sample, or are seen from behind where backs are not, are left out.
void prepare_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const PatchLens& lens,
                     const PatchGrid& grid, const PatchRasterOptions& options, const PatchLook& look,
                     const PatchKernel& kernel, PatchTask& task);

}  // namespace gs::render
