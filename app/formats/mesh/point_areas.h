#pragma once

#include <glm/vec3.hpp>

#include <span>
#include <vector>

namespace gs::app {

/// The area of the surface that each point stands for, from the distances to its twelve nearest neighbours: a disc
/// through the j-th of them holds j + 1/2 points. Within 8 % on even and on random samplings; points at a border
/// get too much. With fewer points all of them count; a point that is alone stands for 1. 0 where many points
/// coincide. O(n log n); coordinates must be finite and below 1e18.
[[nodiscard]] std::vector<float> point_areas(std::span<const glm::vec3> points);

}  // namespace gs::app
