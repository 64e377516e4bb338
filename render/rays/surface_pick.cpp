#include "render/rays/surface_pick.h"

#include "qnv/codecs/displaced/tessellation/patch_mesh.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace gs::render {
namespace {

struct Candidate {
  double enter;
  std::uint32_t part, patch;
};

/// Tests a triangle from both sides (T. Moeller, B. Trumbore, "Fast, minimum storage ray/triangle intersection", 1997).
bool meets(const SightLine& line, const std::array<glm::vec3, 3>& corners, double& distance, glm::dvec3& weights) {
  const glm::dvec3 a(corners[0]), ab = glm::dvec3(corners[1]) - a, ac = glm::dvec3(corners[2]) - a;
  const glm::dvec3 p = glm::cross(line.direction, ac);
  const double determinant = glm::dot(ab, p);
  if (determinant == 0) return false;
  const glm::dvec3 from = line.origin - a, q = glm::cross(from, ab);
  const double b = glm::dot(from, p) / determinant, c = glm::dot(line.direction, q) / determinant;
  constexpr double kEdge = -1e-9;  // tolerance in barycentric coordinates, so that no ray passes between two triangles
  if (!(b >= kEdge && c >= kEdge && b + c <= 1 - kEdge)) return false;
  distance = glm::dot(ac, q) / determinant;
  weights = {1 - b - c, b, c};
  return true;
}

}  // namespace

std::optional<PatchHit> pick_patches(const qnv::SurfacePatches& surface, const SightLine& line, float pixel) {
  std::optional<PatchHit> found;
  const double length = glm::length(line.direction);
  if (!(length > 0) || !std::isfinite(length)) return found;
  std::vector<Candidate> candidates;
  const BoxTree::Walker walker(line);
  for (std::uint32_t s = 0; s < surface.parts.size(); ++s)
    for (std::uint32_t p = 0; p < surface.parts[s]->size(); ++p) {
      const Box& box = surface.parts[s]->bounds(p).box;
      const double enter = walker.enter(box.lower, box.upper, line.farthest);
      if (std::isfinite(enter)) candidates.push_back({enter, s, p});
    }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.enter < b.enter; });
  qnv::LodView view;
  view.eye = glm::vec3(line.origin);
  view.pixels = 1 / pixel;
  double farthest = line.farthest;
  qnv::PatchMesh mesh;
  for (const Candidate& one : candidates) {
    if (one.enter > farthest) break;
    mesh.build(*surface.parts[one.part], qnv::cut_patch(surface, one.part, one.patch, view));
    const std::span<const qnv::PatchVertex> v = mesh.vertices();
    for (const auto& triangles : {mesh.inner(), mesh.border()})
      for (const qnv::PatchMesh::Triangle& t : triangles) {
        const std::array<glm::vec3, 3> corners{v[t[0]].position, v[t[1]].position, v[t[2]].position};
        double distance = 0;
        glm::dvec3 weights(0);
        if (!meets(line, corners, distance, weights) || !(distance >= 0 && distance < farthest)) continue;
        farthest = distance;
        found = PatchHit{distance, one.part, one.patch, corners, weights, glm::vec3(0), corners[0], std::nullopt};
        if (mesh.colors().size() >= v.size()) found->color = glm::vec3(0);
        std::size_t nearest = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          const auto weight = weights[static_cast<glm::length_t>(k)];
          found->normal += qnv::unpack_direction(v[t[k]].normal) * static_cast<float>(weight);
          if (found->color) {
            const qnv::Rgb8& own = mesh.colors()[t[k]];
            *found->color += glm::vec3(own.r, own.g, own.b) * (static_cast<float>(weight) / 255);
          }
          if (weight > weights[static_cast<glm::length_t>(nearest)]) nearest = k;
        }
        found->vertex = corners[nearest];
      }
  }
  return found;
}

}  // namespace gs::render
