#pragma once

#include "render/splat/software/splat_raster.h"
#include "render/splat/splat_gl.h"

#include <span>

namespace gs::render {

/// Returns the maximum width in pixels of the holes that close_pinholes() closes. A gap narrower than half a voxel
/// cannot be a hole of the object.
[[nodiscard]] int closing_for(std::span<const SharedSplatPiece> pieces, const SplatView& view);

/// Closes pinholes between the planes of octree cubes that are seen from the side. A pixel is closed if each of its
/// four sides has a covered pixel within `closing` pixels. It gets the minimum of the four coverages. If it was not
/// covered at all, it gets the mean of the nearest pixels.
///
/// Pixels outside the viewport count as covered. Equals kSplatFragmentShader with CLOSING, except for rounding. Gives
/// identical bits for any number of threads.
void close_pinholes(SplatLayer& layer, const SplatView& view, int closing);

}  // namespace gs::render
