#include "qnv/codecs/displaced/encode/target.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <cstddef>

namespace gs::qnv::displaced {
namespace {

// Minimum cosine between the search direction and the normal of a triangle on the same side of the surface.
constexpr float kSameSide = 0.2f;
constexpr float kShortLook = 1.0f / 8;  // reach of the first search, relative to the full reach
// Two triangles form a crease if the cosine between their corner normals is smaller.
constexpr float kShadedApart = 0.94f;

SurfaceMesh lines_of(const SurfaceMesh& mesh, const Neighbours& beside) {
  SurfaceMesh lines;
  lines.positions = mesh.positions;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3], other = beside[t][k];
      bool line = other == kNone;
      if (!line && other > t && !mesh.normals.empty())
        for (std::size_t l = 0; l < 3; ++l) {
          if (mesh.triangles[other][l] == a)
            line = line || glm::dot(mesh.normals[t][k], mesh.normals[other][l]) < kShadedApart;
          if (mesh.triangles[other][l] == b)
            line = line || glm::dot(mesh.normals[t][(k + 1) % 3], mesh.normals[other][l]) < kShadedApart;
        }
      if (line) lines.triangles.push_back({a, b, b});
    }
  return lines;
}

float mean_edge(const SurfaceMesh& mesh) {
  double sum = 0;
  for (const Corners& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      sum += static_cast<double>(glm::length(mesh.positions[t[k]] - mesh.positions[t[(k + 1) % 3]]));
  return mesh.triangles.empty() ? 0.0f : static_cast<float>(sum / (3.0 * static_cast<double>(mesh.triangles.size())));
}

}  // namespace

Target::Target(const SurfaceMesh& mesh, const Neighbours& beside, unsigned threads)
    : mesh_(mesh),
      lines_(lines_of(mesh_, beside)),
      tree_(mesh_, threads),
      line_tree_(lines_, threads),
      edge_(mean_edge(mesh_)) {}

float Target::distance(const glm::vec3& from, const glm::vec3& normal, float reach, std::uint32_t& triangle) const {
  // Most hits are near. A short search visits few boxes, and its hit is the nearest.
  const float look = kShortLook * reach;
  SurfacePoint hit = triangle == kNone ? SurfacePoint() : tree_.on(triangle, from, normal, look);
  if (hit.triangle == kNone) hit = tree_.along(from, normal, look, normal, kSameSide);
  if (hit.triangle == kNone) hit = tree_.along(from, normal, reach, normal, kSameSide);
  triangle = hit.triangle;
  if (hit.triangle != kNone) return hit.distance + glm::dot(tree_.smooth(hit) - hit.position, normal);
  const SurfacePoint near = tree_.nearest(from, reach, normal, kSameSide);
  return near.triangle == kNone ? 0.0f : glm::dot(near.position - from, normal);
}

SurfacePoint Target::line(const glm::vec3& from, float reach) const {
  return line_tree_.nearest(from, reach, glm::vec3(0), -1.0f);
}

glm::vec3 Target::color(const glm::vec3& from, const glm::vec3& normal, float reach) const {
  SurfacePoint there = tree_.nearest(from, reach, normal, kSameSide);
  if (there.triangle == kNone) there = tree_.nearest(from, 8 * reach, normal, -1.0f);
  if (there.triangle == kNone) return glm::vec3(204);
  const glm::vec3 weights = tree_.weights(there);
  glm::vec3 sum(0);
  for (int k = 0; k < 3; ++k) {
    const Rgb8 c = mesh_.colors[mesh_.triangles[there.triangle][static_cast<std::size_t>(k)]];
    sum += weights[k] * glm::vec3(c.r, c.g, c.b);
  }
  return glm::clamp(sum, glm::vec3(0), glm::vec3(255));
}

}  // namespace gs::qnv::displaced
