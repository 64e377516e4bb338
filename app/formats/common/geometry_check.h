#pragma once

#include "app/formats/common/mesh_asset.h"

namespace gs::app {

/// Removes faces, lines and points that cannot be drawn, with their entries in the other index and colour arrays.
/// Reports missing vertices and non-finite coordinates to `context`; faces under 3 corners and lines under 2 are
/// removed without a message. Unused non-finite coordinates become 0 0 0, so that the scene can be printed; so do
/// normals and texture coordinates. Clamps colours to 0..1. Clears index arrays that do not match coord_index, with the
/// arrays that they index. Returns false if nothing is left.
[[nodiscard]] bool keep_drawable(Geometry& data, ImportContext& context);

}  // namespace gs::app
