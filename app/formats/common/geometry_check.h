#pragma once

#include "app/formats/common/scene_builder.h"

#include <cstddef>

namespace gs::app {

/// Counts of elements removed from a Geometry.
struct GeometryLoss {
  std::size_t bad_index = 0;   // faces, lines or points with indices out of range
  std::size_t not_finite = 0;  // faces, lines or points with infinite or NaN coordinates
};

/// Removes faces, lines and points that cannot be drawn, with their entries in the other index and colour arrays. Faces
/// under 3 corners and lines under 2 are removed without being counted. Unused non-finite coordinates become 0 0 0, so
/// that the scene can be printed; so do normals and texture coordinates. Clamps colours to 0..1. Clears index arrays
/// that do not match coord_index, with the arrays that they index.
GeometryLoss drop_what_is_broken(Geometry& data);

}  // namespace gs::app
