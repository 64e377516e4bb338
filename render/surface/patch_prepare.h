#pragma once

#include "render/surface/patch_raster.h"
#include "render/surface/patch_screen.h"

namespace gs::render {

/// Vertices and triangles of the patches of a task, on the screen and sorted by tile; those that cover no sample, or
/// are seen from behind where backs are not, are left out. `colored`: vertices have colours.
void prepare_patches(const qnv::SurfacePatches& surface, const qnv::SurfaceCut& cut, const PatchLens& lens,
                     const PatchGrid& grid, const PatchRasterOptions& options, bool colored, PatchTask& task);

}  // namespace gs::render
