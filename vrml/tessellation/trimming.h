#pragma once

#include <glm/vec2.hpp>

#include <cstddef>
#include <vector>

namespace gs::vrml {

/// Returns the part of the unit square inside closed contours, by the even-odd rule, as convex polygons in
/// counter-clockwise order. Each polygon lies in one cell of a grid of columns x rows, so that a curved surface can
/// replace it. Where contours cross between two of their corners, the boundary is approximate.
[[nodiscard]] std::vector<std::vector<glm::dvec2>> trim(const std::vector<std::vector<glm::dvec2>>& contours,
                                                        std::size_t columns, std::size_t rows);

/// Returns a limit for the number of corners that trim() returns.
[[nodiscard]] std::size_t most_corners(const std::vector<std::vector<glm::dvec2>>& contours, std::size_t columns,
                                       std::size_t rows);

}  // namespace gs::vrml
