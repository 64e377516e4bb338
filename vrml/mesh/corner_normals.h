#pragma once

#include "vrml/mesh/attribute.h"
#include "vrml/mesh/vertices.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gs::vrml {

/// Returns the unit normal of a polygon by the right-hand rule. The polygon has at least three corners. Returns zero if
/// its area is zero. `scratch` is working memory.
[[nodiscard]] glm::vec3 face_normal(std::span<const std::uint32_t> corners, std::span<const std::int32_t> coord_index,
                                    std::span<const glm::vec3> points, std::vector<glm::vec3>& scratch);

/// Generates normals for faces without given normals (VRML97 4.6.3.5). The normal of a corner is the area-weighted mean
/// of the normals of faces around its vertex. Only faces at an angle below `crease_angle` (radians, > 0) to the
/// corner's face count. The result is by_vertex if no edge is sharp; otherwise by_corner with an index. Takes about
/// linear time for any input: at vertices with more than 256 faces, compares groups of faces with similar normals.
[[nodiscard]] Attribute<glm::vec3> crease_normals(std::span<const std::int32_t> coord_index,
                                                  std::span<const glm::vec3> points, const UsableVertices& vertices,
                                                  bool ccw, float crease_angle);

}  // namespace gs::vrml
