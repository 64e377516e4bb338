#pragma once

#include "vrml/mesh/mesh.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <limits>

namespace gs::render {

/// Box in world space in double precision, exact even far from 0. Empty if lower > upper.
struct WorldBounds {
  glm::dvec3 lower{std::numeric_limits<double>::infinity()};
  glm::dvec3 upper{-std::numeric_limits<double>::infinity()};

  WorldBounds() = default;
  WorldBounds(const glm::dvec3& least, const glm::dvec3& most) : lower(least), upper(most) {}
  WorldBounds(const vrml::Bounds& bounds) : lower(bounds.lower), upper(bounds.upper) {}  // lossless

  [[nodiscard]] bool empty() const { return !(lower.x <= upper.x); }
  void add(const glm::dvec3& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  void add(const WorldBounds& other) {
    if (other.empty()) return;
    add(other.lower);
    add(other.upper);
  }
  [[nodiscard]] glm::dvec3 center() const { return (lower + upper) * 0.5; }
  [[nodiscard]] glm::vec3 size() const { return glm::vec3(upper - lower); }
};

/// Returns the world-space box of a node-space box; empty if a coordinate does not fit float32.
[[nodiscard]] WorldBounds world_bounds(const vrml::Bounds& bounds, const glm::dmat4& world_from_local);

}  // namespace gs::render
