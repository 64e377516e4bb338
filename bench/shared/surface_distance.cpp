#include "bench/shared/surface_distance.h"

#include "qnv/mesh/triangle_tree.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace gs::bench {
namespace {

using qnv::displaced::SurfaceMesh;
using qnv::displaced::TriangleTree;

constexpr std::size_t kSamples = 50'000;

/// Scales to a box of diagonal 1, in which float32 distinguishes all positions.
SurfaceMesh framed(const Mesh& mesh, const glm::dvec3& lower, double diagonal) {
  SurfaceMesh out;
  for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3)
    out.positions.emplace_back((glm::dvec3(mesh.positions[i], mesh.positions[i + 1], mesh.positions[i + 2]) - lower) /
                               diagonal);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    out.triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
  return out;
}

SurfaceDistance one_way(const SurfaceMesh& from, const TriangleTree& to) {
  std::vector<double> sums;
  double area = 0;
  for (const auto& t : from.triangles) {
    const glm::vec3 a = from.positions[t[0]];
    area += 0.5 * static_cast<double>(glm::length(glm::cross(from.positions[t[1]] - a, from.positions[t[2]] - a)));
    sums.push_back(area);
  }
  std::mt19937 random(1);
  const auto next = [&] { return static_cast<double>(random()) / 4294967296.0; };
  SurfaceDistance found;
  double squares = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double at = (static_cast<double>(i) + next()) / kSamples * area;
    const auto t = std::min<std::size_t>(static_cast<std::size_t>(std::ranges::lower_bound(sums, at) - sums.begin()),
                                         sums.size() - 1);
    const auto& corners = from.triangles[t];
    double u = next(), v = next();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const glm::vec3 a = from.positions[corners[0]];
    const glm::vec3 place = a + static_cast<float>(u) * (from.positions[corners[1]] - a) +
                            static_cast<float>(v) * (from.positions[corners[2]] - a);
    const auto near = to.nearest(place, std::numeric_limits<float>::max(), glm::vec3(0), -1.0f);
    const auto distance = static_cast<double>(near.distance);
    squares += distance * distance;
    found.mean += distance / kSamples;
    found.most = std::max(found.most, distance);
  }
  found.root_mean_square = std::sqrt(squares / kSamples);
  return found;
}

}  // namespace

double SurfaceDistance::psnr() const { return -20 * std::log10(std::max(root_mean_square, 1e-9)); }

SurfaceDistance surface_distance(const Mesh& original, const Mesh& other) {
  glm::dvec3 lower(std::numeric_limits<double>::max()), upper(std::numeric_limits<double>::lowest());
  for (const unsigned i : original.indices) {
    const glm::dvec3 p(original.positions[3 * i], original.positions[3 * i + 1], original.positions[3 * i + 2]);
    lower = glm::min(lower, p);
    upper = glm::max(upper, p);
  }
  const double diagonal = glm::length(upper - lower);
  const SurfaceMesh a = framed(original, lower, diagonal), b = framed(other, lower, diagonal);
  const TriangleTree tree_a(a), tree_b(b);
  const SurfaceDistance there = one_way(a, tree_b), back = one_way(b, tree_a);
  return {std::max(there.root_mean_square, back.root_mean_square), std::max(there.mean, back.mean),
          std::max(there.most, back.most)};
}

Mesh mesh_of(const qnv::IndexedMesh& surface) {
  Mesh mesh;
  for (const glm::vec3& p : surface.positions) mesh.positions.insert(mesh.positions.end(), {p.x, p.y, p.z});
  mesh.indices.assign(surface.triangles.begin(), surface.triangles.end());
  return mesh;
}

}  // namespace gs::bench
