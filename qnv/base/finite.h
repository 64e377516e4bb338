#pragma once

#include <glm/vec3.hpp>

#include <cmath>

namespace gs::qnv {

/// Whether all three components are finite numbers. Pure; any thread.
[[nodiscard]] inline bool finite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace gs::qnv
