#include "render/rays/gaussian_pick.h"

#include "base/finite.h"
#include "base/parallel.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace gs::render {
namespace {

constexpr std::size_t kGaussianRange = 65536;  // splats per task
constexpr float kLeastOpacity = 1 / 255.0f;
constexpr float kTaken = 0.5f;      // share of the light
constexpr float kThinnest = 1e-4f;  // of a splat's axes, relative to its longest

struct Crossing {
  float distance, opacity;
  const qnv::Gaussians* gaussians;
  std::size_t splat;
};

/// Ray in the coordinates of a node.
struct GaussianRay {
  glm::vec3 origin, direction;
  float farthest;
};

void add_crossings(const GaussianPart& part, const GaussianRay& ray, std::vector<Crossing>& found) {
  const qnv::Gaussians& all = *part.gaussians;
  const std::size_t first = std::min(part.first, all.size()), count = std::min(part.count, all.size() - first);
  for (std::size_t i = first; i < first + count; ++i) {
    const glm::vec3& scales = all.scales[i];
    const float longest = std::max({scales.x, scales.y, scales.z});
    if (!(longest > 0)) continue;
    // Scales by the standard deviations, so that the splat becomes a sphere.
    const glm::vec3 s = glm::max(scales, glm::vec3(longest * kThinnest));
    const glm::vec4& q = all.rotations[i];
    const glm::quat own_from_node(q.w, -q.x, -q.y, -q.z);
    const glm::vec3 from = own_from_node * (ray.origin - all.positions[i]) / s,
                    along = own_from_node * ray.direction / s;
    const float distance = -glm::dot(from, along) / glm::dot(along, along);
    if (!(distance > 0 && distance < ray.farthest)) continue;
    const glm::vec3 nearest = from + along * distance;
    const float opacity = std::min(all.opacities[i], 0.99f) * std::exp(-0.5f * glm::dot(nearest, nearest));
    if (opacity >= kLeastOpacity) found.push_back({distance, opacity, &all, i});
  }
}

qnv::Rgb8 color_of(const qnv::Gaussians& all, std::size_t splat) {
  if (all.colors.size() == all.size()) return all.colors[splat];
  const auto part = [](float c) { return static_cast<std::uint8_t>(std::lround(std::clamp(c, 0.0f, 1.0f) * 255)); };
  return {part(all.bases[splat].x), part(all.bases[splat].y), part(all.bases[splat].z)};
}

}  // namespace

std::optional<DiscPick> pick_gaussians(std::span<const GaussianPart> parts, const glm::dmat4& world_from_node,
                                       const PickRay& ray, const PickLimits& limits) {
  const glm::dmat3 linear(world_from_node);
  const double determinant = glm::determinant(linear);
  if (!(std::abs(determinant) > 0) || !std::isfinite(determinant)) return std::nullopt;
  const glm::dmat3 inverse = glm::inverse(linear);
  const GaussianRay own{inverse * (ray.origin - glm::dvec3(world_from_node[3])),
                        inverse * glm::dvec3(ray.direction),  // length of one world unit
                        ray.farthest};
  if (!finite(own.origin) || !finite(own.direction)) return std::nullopt;
  std::vector<GaussianPart> tasks;
  for (const GaussianPart& part : parts)
    for (std::size_t first = 0; first < part.count; first += kGaussianRange)
      tasks.push_back({part.gaussians, part.first + first, std::min(kGaussianRange, part.count - first)});
  std::vector<std::vector<Crossing>> found(tasks.size());
  parallel_for(
      tasks.size(), [&](std::size_t t) { add_crossings(tasks[t], own, found[t]); },
      tasks.size() > 1 ? limits.threads : 1);
  std::vector<Crossing> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  std::ranges::stable_sort(all, {}, &Crossing::distance);
  float clear = 1;
  for (const Crossing& crossing : all) {
    clear *= 1 - crossing.opacity;
    if (clear > 1 - kTaken) continue;
    DiscPick pick;
    pick.distance = crossing.distance;
    pick.color = color_of(*crossing.gaussians, crossing.splat);
    return pick;
  }
  return std::nullopt;
}

}  // namespace gs::render
