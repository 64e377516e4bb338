#pragma once

#include "base/box.h"

#include <glm/mat4x4.hpp>

namespace gs::render {

/// Returns the world-space box around a box in node space. Returns an empty box if a coordinate exceeds the range of
/// float32.
[[nodiscard]] WideBox world_bounds(const Box& bounds, const glm::dmat4& world_from_local);

}  // namespace gs::render
