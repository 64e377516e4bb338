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
  std::size_t splat;
};

}  // namespace

std::optional<DiscPick> pick_gaussians(const qnv::Gaussians& gaussians, const glm::dmat4& world_from_node,
                                       const PickRay& ray, const PickLimits& limits) {
  const glm::dmat3 linear(world_from_node);
  const double determinant = glm::determinant(linear);
  if (!(std::abs(determinant) > 0) || !std::isfinite(determinant)) return std::nullopt;
  const glm::dmat3 inverse = glm::inverse(linear);
  const glm::vec3 origin(inverse * (ray.origin - glm::dvec3(world_from_node[3]))),
      direction(inverse * glm::dvec3(ray.direction));  // one world unit
  if (!finite(origin) || !finite(direction)) return std::nullopt;
  const std::size_t count = gaussians.size();
  std::vector<std::vector<Crossing>> found((count + kGaussianRange - 1) / kGaussianRange);
  parallel_for(
      found.size(),
      [&](std::size_t r) {
        for (std::size_t i = r * kGaussianRange; i < std::min(count, (r + 1) * kGaussianRange); ++i) {
          const glm::vec3& scales = gaussians.scales[i];
          const float longest = std::max({scales.x, scales.y, scales.z});
          if (!(longest > 0)) continue;
          // In units of the standard deviations, the splat is round.
          const glm::vec3 s = glm::max(scales, glm::vec3(longest * kThinnest));
          const glm::vec4& q = gaussians.rotations[i];
          const glm::quat own_from_node(q.w, -q.x, -q.y, -q.z);
          const glm::vec3 from = own_from_node * (origin - gaussians.positions[i]) / s,
                          along = own_from_node * direction / s;
          const float distance = -glm::dot(from, along) / glm::dot(along, along);
          if (!(distance > 0 && distance < ray.farthest)) continue;
          const glm::vec3 nearest = from + along * distance;
          const float opacity = std::min(gaussians.opacities[i], 0.99f) * std::exp(-0.5f * glm::dot(nearest, nearest));
          if (opacity >= kLeastOpacity) found[r].push_back({distance, opacity, i});
        }
      },
      count > kGaussianRange ? limits.threads : 1);
  std::vector<Crossing> all;
  for (const auto& part : found) all.insert(all.end(), part.begin(), part.end());
  std::ranges::stable_sort(all, {}, &Crossing::distance);
  float clear = 1;
  for (const Crossing& crossing : all) {
    clear *= 1 - crossing.opacity;
    if (clear > 1 - kTaken) continue;
    DiscPick pick;
    pick.distance = crossing.distance;
    if (gaussians.colors.size() == count) pick.color = gaussians.colors[crossing.splat];
    return pick;
  }
  return std::nullopt;
}

}  // namespace gs::render
