#pragma once

#include "render/splat/splat_gl.h"
#include "render/splat/splat_raster.h"

#include <span>

namespace gs::render {

/// How wide the holes are that close_pinholes closes in a picture of these pieces, in pixels: what is narrower than
/// half a voxel is no hole of the object, because the voxels could not show it.
[[nodiscard]] int closing_for(std::span<const SharedSplatPiece> pieces, const SplatView& view);

/// Cubes of an octree that are seen from the side can leave pinholes between their planes. A pixel that has covered
/// ones on all four sides, no further than `closing`, is taken to be covered like the least of them, and if it was not
/// at all, to be the mean of the nearest. What lies beyond the edge of the viewport counts as covered. The same as
/// kSplatFragmentShader does with CLOSING, up to rounding, and the same bits whatever the number of threads.
void close_pinholes(SplatLayer& layer, const SplatView& view, int closing);

}  // namespace gs::render
