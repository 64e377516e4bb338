#pragma once

#include "render/scene/shape_style.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>

namespace gs::render {

/// Intersection of the half spaces of ClipPlanes. A point p is inside if dot(plane, (p, 1)) is positive for each plane.
struct ClipSpace {
  std::size_t count = 0;
  std::array<glm::vec4, kMaxClipPlanes> planes{};

  [[nodiscard]] bool contains(const glm::vec3& point) const {
    for (std::size_t i = 0; i < count; ++i) {
      const glm::vec4& plane = planes[i];
      if (plane.x * point.x + plane.y * point.y + plane.z * point.z + plane.w < 0) return false;
    }
    return true;
  }
};

}  // namespace gs::render
