#pragma once

#include <glm/vec3.hpp>

#include <span>
#include <vector>

namespace gs::vrml {

/// Axes of a spine-aligned cross-section plane, unit and perpendicular (VRML97 6.18.2): y along the
/// spine, x and z those of the cross-section.
struct CrossSectionPlane {
  glm::dvec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

/// The plane at each point of a spine, with the special cases of VRML97 6.18.3: closed spines, points
/// in a line, points that coincide. Points that are not finite have no say in the other planes.
[[nodiscard]] std::vector<CrossSectionPlane> cross_section_planes(std::span<const glm::vec3> spine);

}  // namespace gs::vrml
