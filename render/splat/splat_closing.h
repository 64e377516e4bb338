#pragma once

#include "render/splat/splat_gl.h"
#include "render/splat/splat_raster.h"

#include <span>

namespace gs::render {

/// Returns the maximum width, in pixels, of holes that close_pinholes closes. Gaps narrower than half a voxel cannot be
/// holes of the object.
[[nodiscard]] int closing_for(std::span<const SharedSplatPiece> pieces, const SplatView& view);

/// Closes pinholes between the planes of octree cubes seen from the side. A pixel with covered ones on all four sides
/// within `closing` gets the minimum of their coverage; if it was not covered at all, it gets the mean of the nearest
/// ones. Pixels outside the viewport count as covered. Matches kSplatFragmentShader with CLOSING up to rounding, and
/// gives the same bits for any number of threads.
void close_pinholes(SplatLayer& layer, const SplatView& view, int closing);

}  // namespace gs::render
