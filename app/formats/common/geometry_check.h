#pragma once

#include "app/formats/common/scene_builder.h"

#include <cstddef>

namespace gs::app {

/// What was left out of a Geometry.
struct GeometryLoss {
  std::size_t bad_index = 0;   // faces, lines or points whose indices reach beyond an array
  std::size_t not_finite = 0;  // ... whose coordinates are infinite or NaN
};

/// Leaves out every face (line, point) that cannot be drawn, and what belongs to it in the other index
/// and colour arrays; faces under 3 corners and lines under 2 go without being counted. Coordinates that
/// are not finite, and no longer used, become 0 0 0, so that the scene can be printed; so do normals and
/// texture coordinates. Colours are clamped to 0..1. Index arrays that do not fit to coord_index are emptied together
/// with what they index.
GeometryLoss drop_what_is_broken(Geometry& data);

}  // namespace gs::app
