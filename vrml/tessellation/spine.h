#pragma once

#include <glm/vec3.hpp>

#include <span>
#include <vector>

namespace gs::vrml {

/// Unit axes of the plane of a cross-section (VRML97 6.18.2). y follows the spine; x and z are the axes of the
/// cross-section.
struct CrossSectionPlane {
  glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

/// Returns the plane at each point of a spine. Handles the special cases of VRML97 6.18.3: closed spines, collinear
/// points, coincident points. Points that are not finite do not affect the planes at other points.
[[nodiscard]] std::vector<CrossSectionPlane> cross_section_planes(std::span<const glm::vec3> spine);

}  // namespace gs::vrml
