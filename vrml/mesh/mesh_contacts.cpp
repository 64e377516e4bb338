#include "vrml/mesh/mesh_contacts.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace gs::vrml {
namespace {

using Triangle = std::array<glm::dvec3, 3>;

Triangle triangle_at(const Mesh& mesh, std::size_t first) {
  return {glm::dvec3(mesh.positions[mesh.indices[first]]), glm::dvec3(mesh.positions[mesh.indices[first + 1]]),
          glm::dvec3(mesh.positions[mesh.indices[first + 2]])};
}

WideBox box_around(const Triangle& triangle) {
  WideBox box;
  for (const glm::dvec3& corner : triangle) box.add(corner);
  return box;
}

struct Crossing {
  double part = 0, u = 0, v = 0;  // position on the line; barycentric coordinates of corners 1 and 2
};

// Intersects a line with a triangle (Moeller and Trumbore).
std::optional<Crossing> crossing(const Triangle& t, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 direction = to - from, one = t[1] - t[0], two = t[2] - t[0], p = glm::cross(direction, two);
  const double determinant = glm::dot(one, p);
  if (determinant == 0 || !std::isfinite(determinant)) return std::nullopt;
  const glm::dvec3 s = from - t[0];
  const double u = glm::dot(s, p) / determinant;
  if (!(u >= 0 && u <= 1)) return std::nullopt;
  const glm::dvec3 q = glm::cross(s, one);
  const double v = glm::dot(direction, q) / determinant;
  if (!(v >= 0 && u + v <= 1)) return std::nullopt;
  const double part = glm::dot(two, q) / determinant;
  if (!(part >= 0 && part <= 1)) return std::nullopt;
  return Crossing{part, u, v};
}

bool edges_cross(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (crossing(b, a[i], a[(i + 1) % a.size()])) return true;
  return false;
}

// Returns the triangles of a mesh that overlap `near`, after the transformation.
std::vector<Triangle> triangles_near(const Mesh& mesh, const glm::dmat4& matrix, const WideBox& near) {
  std::vector<Triangle> found;
  if (mesh.primitive != Mesh::Primitive::triangles) return found;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Triangle triangle = triangle_at(mesh, i);
    for (glm::dvec3& corner : triangle) corner = glm::dvec3(matrix * glm::dvec4(corner, 1));
    if (do_overlap(box_around(triangle), near)) found.push_back(triangle);
  }
  return found;
}

}  // namespace

void append_crossings(const Mesh& mesh, const glm::dvec3& from, const glm::dvec3& to, std::size_t max_points,
                      std::vector<SurfacePoint>& points) {
  if (mesh.primitive != Mesh::Primitive::triangles) return;
  WideBox line;
  line.add(from);
  line.add(to);
  for (std::size_t i = 0; i + 2 < mesh.indices.size() && points.size() < max_points; i += 3) {
    const Triangle triangle = triangle_at(mesh, i);
    if (!do_overlap(box_around(triangle), line)) continue;
    const auto found = crossing(triangle, from, to);
    if (!found) continue;
    SurfacePoint point;
    point.part = found->part;
    point.point = from + (to - from) * found->part;
    const auto at = [&](std::size_t corner) { return mesh.indices[i + corner]; };
    const double first = 1 - found->u - found->v;
    point.normal = mesh.normals.empty()
                       ? glm::cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
                       : glm::dvec3(mesh.normals[at(0)]) * first + glm::dvec3(mesh.normals[at(1)]) * found->u +
                             glm::dvec3(mesh.normals[at(2)]) * found->v;
    const double length = glm::length(point.normal);
    if (length > 0) point.normal /= length;
    if (!mesh.texture_coordinates.empty())
      point.texture_coordinate = mesh.texture_coordinates[at(0)] * static_cast<float>(first) +
                                 mesh.texture_coordinates[at(1)] * static_cast<float>(found->u) +
                                 mesh.texture_coordinates[at(2)] * static_cast<float>(found->v);
    points.push_back(point);
  }
}

// Counts the crossings of a half-line. Its direction is unlikely to hit an edge, where two triangles count.
bool is_inside(const Mesh& mesh, const glm::dvec3& point) {
  if (mesh.primitive != Mesh::Primitive::triangles || mesh.bounds.empty()) return false;
  const WideBox bounds(mesh.bounds);
  if (!do_overlap({point, point}, bounds)) return false;
  const glm::dvec3 to = point + glm::dvec3(0.8312, 0.3917, 0.2765) * (4.0 * double{glm::length(bounds.size())} + 1);
  std::size_t count = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    count += crossing(triangle_at(mesh, i), point, to) ? 1 : 0;
  return count % 2 == 1;
}

bool do_meet(const Mesh& a, const glm::dmat4& b_from_a, const Mesh& b) {
  if (a.empty() || b.empty()) return false;
  const WideBox near_b(b.bounds), near_a = box_of(a.bounds, b_from_a);
  if (!do_overlap(near_a, near_b)) return false;
  const std::vector<Triangle> from_a = triangles_near(a, b_from_a, near_b),
                              from_b = triangles_near(b, glm::dmat4(1), near_a);
  const bool all = from_a.size() * from_b.size() <= kMaxTrianglePairs;
  for (const Triangle& one : from_a) {
    const WideBox box = box_around(one);
    for (const Triangle& other : from_b)
      if (do_overlap(box, box_around(other)) && (!all || edges_cross(one, other) || edges_cross(other, one)))
        return true;
    if (!all) break;
  }
  if (!all) return true;
  const glm::dvec3 corner_a(b_from_a * glm::dvec4(a.positions[a.indices[0]], 1)),
      corner_b(glm::inverse(b_from_a) * glm::dvec4(b.positions[b.indices[0]], 1));
  return is_inside(b, corner_a) || is_inside(a, corner_b);
}

WideBox box_of(const Box& box, const glm::dmat4& matrix) {
  WideBox result;
  if (box.empty()) return result;
  for (int i = 0; i < 8; ++i)
    result.add(glm::dvec3(matrix * glm::dvec4(i & 1 ? box.upper.x : box.lower.x, i & 2 ? box.upper.y : box.lower.y,
                                              i & 4 ? box.upper.z : box.lower.z, 1)));
  return result;
}

bool do_overlap(const WideBox& a, const WideBox& b) {
  for (int i = 0; i < 3; ++i)
    if (!(a.lower[i] <= b.upper[i] && b.lower[i] <= a.upper[i])) return false;
  return true;
}

}  // namespace gs::vrml
