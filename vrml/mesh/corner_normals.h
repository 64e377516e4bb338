#pragma once

#include "vrml/mesh/attribute.h"
#include "vrml/mesh/vertices.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Unit normal by the right hand rule of a polygon of at least three corners; zero where it has no
/// area at all. `scratch` is memory to work in.
[[nodiscard]] glm::vec3 face_normal(std::span<const std::uint32_t> corners, std::span<const std::int32_t> coord_index,
                                    std::span<const glm::vec3> points, std::vector<glm::vec3>& scratch);

/// Normals for faces that have none of their own (VRML97 4.6.3.5): at each corner the mean, weighted
/// by area, of the normals of those faces around the vertex whose angle with the corner's own face is
/// less than `crease_angle` (radians, > 0). One value a coordinate where no edge is sharp (by_vertex),
/// else with an index (by_corner). About linear in the corners, whatever the input; around vertices of
/// more than 256 faces the angles are taken between groups of faces that look nearly the same way.
[[nodiscard]] Attribute<glm::vec3> crease_normals(std::span<const std::int32_t> coord_index,
                                                  std::span<const glm::vec3> points, const UsableVertices& vertices,
                                                  bool ccw, float crease_angle);

}  // namespace gs::vrml
