#pragma once

#include "vrml/mesh/attribute.h"
#include "vrml/mesh/vertices.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Returns the unit normal of a polygon of at least three corners by the right-hand rule; zero if its area is zero.
/// `scratch` is working memory.
[[nodiscard]] glm::vec3 face_normal(std::span<const std::uint32_t> corners, std::span<const std::int32_t> coord_index,
                                    std::span<const glm::vec3> points, std::vector<glm::vec3>& scratch);

/// Generates normals for faces without given normals (VRML97 4.6.3.5). Each corner gets the area-weighted mean of
/// normals of faces around the vertex. A face counts if its angle to the corner's face is below `crease_angle`
/// (radians, > 0). The result is by_vertex if no edge is sharp, else by_corner with an index. Takes about linear time
/// for any input: around vertices of more than 256 faces, it compares groups of faces with similar normals.
[[nodiscard]] Attribute<glm::vec3> crease_normals(std::span<const std::int32_t> coord_index,
                                                  std::span<const glm::vec3> points, const UsableVertices& vertices,
                                                  bool ccw, float crease_angle);

}  // namespace gs::vrml
