#include "render/rays/mesh_bvh.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace gs::render {
namespace {

// Tests a triangle (Moeller and Trumbore). A line through an edge, within rounding, hits both adjacent triangles, so
// that no line passes between them.
void meet_triangle(const vrml::Mesh& mesh, std::uint32_t triangle, const SightLine& line,
                   std::optional<TriangleHit>& nearest) {
  constexpr double kEdge = 1e-9;
  const std::uint32_t* corners = mesh.indices.data() + std::size_t{3} * triangle;
  const glm::dvec3 a(mesh.positions[corners[0]]);
  const glm::dvec3 ab = glm::dvec3(mesh.positions[corners[1]]) - a, ac = glm::dvec3(mesh.positions[corners[2]]) - a;
  const glm::dvec3 p = glm::cross(line.direction, ac);
  const double determinant = glm::dot(ab, p);
  if (determinant == 0 || !std::isfinite(determinant)) return;
  const glm::dvec3 s = line.origin - a;
  const double u = glm::dot(s, p) / determinant;
  if (!(u >= -kEdge && u <= 1 + kEdge)) return;
  const glm::dvec3 q = glm::cross(s, ab);
  const double v = glm::dot(line.direction, q) / determinant;
  if (!(v >= -kEdge && u + v <= 1 + kEdge)) return;
  const double distance = glm::dot(ac, q) / determinant;
  if (!(distance > 0 && distance <= line.farthest)) return;
  if (nearest && (distance > nearest->distance || (distance == nearest->distance && triangle > nearest->triangle)))
    return;
  const double second = std::clamp(u, 0.0, 1.0), third = std::clamp(v, 0.0, 1 - second);
  nearest = TriangleHit{distance, triangle, {1 - second - third, second, third}};
}

}  // namespace

MeshBvh::MeshBvh(const vrml::Mesh& mesh) {
  const std::size_t triangles = mesh.indices.size() / 3;
  if (triangles <= kFewTriangles || mesh.primitive != vrml::Mesh::Primitive::triangles) return;
  std::vector<BoxTree::Entry> entries;
  entries.reserve(triangles);
  for (std::size_t i = 0; i < triangles; ++i) {
    Box box;
    glm::vec3 sum(0);
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec3& corner = mesh.positions[mesh.indices[3 * i + k]];
      box.add(corner);
      sum += corner * 0.0f;
    }
    if (sum == glm::vec3(0)) entries.push_back({box, static_cast<std::uint32_t>(i)});
  }
  tree_ = BoxTree(std::move(entries));
}

std::optional<TriangleHit> MeshBvh::nearest(const vrml::Mesh& mesh, const SightLine& line) const {
  if (mesh.indices.size() / 3 <= kFewTriangles) return nearest_of_all(mesh, line);
  std::optional<TriangleHit> found;
  tree_.visit(line, [&](std::uint32_t triangle, double farthest) {
    meet_triangle(mesh, triangle, line, found);
    return found ? found->distance : farthest;
  });
  return found;
}

std::optional<TriangleHit> nearest_of_all(const vrml::Mesh& mesh, const SightLine& line) {
  std::optional<TriangleHit> found;
  if (mesh.primitive != vrml::Mesh::Primitive::triangles) return found;
  for (std::size_t i = 0; i < mesh.indices.size() / 3; ++i)
    meet_triangle(mesh, static_cast<std::uint32_t>(i), line, found);
  return found;
}

}  // namespace gs::render
