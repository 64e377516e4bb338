#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace gs {

/// Reports whether every component is finite. Pure; safe from any thread.
[[nodiscard]] inline bool finite(float x) { return std::isfinite(x); }
[[nodiscard]] inline bool finite(const glm::vec2& v) { return finite(v.x) && finite(v.y); }
[[nodiscard]] inline bool finite(const glm::vec3& v) { return finite(v.x) && finite(v.y) && finite(v.z); }
[[nodiscard]] inline bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
[[nodiscard]] inline bool finite(const glm::quat& q) {
  return finite(q.w) && finite(q.x) && finite(q.y) && finite(q.z);
}

}  // namespace gs
