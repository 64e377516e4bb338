#pragma once

#include "vrml/mesh/mesh.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

// Intersections of meshes, for picking sensors (X3D clause 38).
namespace gs::vrml {

/// Point of a surface, in the space of its mesh.
struct SurfacePoint {
  glm::dvec3 point{0}, normal{0};
  glm::vec2 texture_coordinate{0};
  double part = 0;  // position on the line, 0 to 1
};

/// Appends the points at which the line from `from` to `to` passes through triangles of the mesh, at most `max_points`.
void append_crossings(const Mesh& mesh, const glm::dvec3& from, const glm::dvec3& to, std::size_t max_points,
                      std::vector<SurfacePoint>& points);

/// Reports whether a point is inside of a closed surface.
[[nodiscard]] bool is_inside(const Mesh& mesh, const glm::dvec3& point);

/// Maximum number of pairs of triangles that do_meet() compares.
inline constexpr std::size_t kMaxTrianglePairs = std::size_t{1} << 20;
/// Reports whether two closed surfaces have a common point: triangles intersect, or one surface is inside of the other.
/// If there are more than kMaxTrianglePairs, reports whether the boxes of the triangles overlap.
[[nodiscard]] bool do_meet(const Mesh& a, const glm::dmat4& b_from_a, const Mesh& b);

/// Returns the box around a transformed box.
[[nodiscard]] WideBox box_of(const Box& box, const glm::dmat4& matrix);
/// Reports whether two boxes have a common point.
[[nodiscard]] bool do_overlap(const WideBox& a, const WideBox& b);

}  // namespace gs::vrml
