#pragma once

#include <glm/vec3.hpp>

#include <cmath>

namespace gs::render {

/// No component is infinite or no number.
[[nodiscard]] inline bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace gs::render
