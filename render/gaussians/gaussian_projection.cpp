#include "render/gaussians/gaussian_harmonics.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/volume/volume_lens.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gs::render {
namespace {

constexpr float kLog2E = 1.44269504f;

}  // namespace

void project_gaussians(const GaussianItem& item, const SplatView& view, std::size_t first, std::size_t last,
                       std::vector<GaussianSplat>& splats, std::vector<float>& distances) {
  const std::optional<VolumeLens> lens = volume_lens(view, item.camera_from_node);
  if (!lens || !item.gaussians) return;
  const qnv::Gaussians& g = *item.gaussians;
  const glm::mat3 linear(item.camera_from_node);
  const glm::vec3 eye = glm::inverse(linear) * -glm::vec3(item.camera_from_node[3]);
  const std::size_t end = std::min({last, item.count, g.size()}), per = qnv::harmonic_count(g.degree);
  const float left = (view.center.x - kGaussianFarthestTangent * view.tangents.x),
              right = (view.center.x + kGaussianFarthestTangent * view.tangents.x),
              low = (view.center.y - kGaussianFarthestTangent * view.tangents.y),
              high = (view.center.y + kGaussianFarthestTangent * view.tangents.y);
  for (std::size_t i = first; i < end; ++i) {
    const glm::vec3& position = g.positions[i];
    const glm::vec3 seen(item.camera_from_node * glm::vec4(position, 1.0f));
    const float depth = -seen.z;
    if (!(depth > view.near_plane && depth > 0)) continue;
    float opacity = g.opacities[i] * item.opacity;
    if (!(opacity >= kGaussianLeastAlpha)) continue;
    if (item.clip && !(glm::dot(glm::vec3(*item.clip), position) + item.clip->w >= 0)) continue;
    const float near = 1 / depth, across = lens->pixels_x * near, up = lens->pixels_y * near;
    // J at the centre: the change of the pixel with the camera-space position.
    const float along_x = across * std::clamp(seen.x * near, left, right),
                along_y = up * std::clamp(seen.y * near, low, high);
    const glm::vec4& q = g.rotations[i];
    const glm::mat3 axes = linear * glm::mat3_cast(glm::quat(q.w, q.x, q.y, q.z));
    float xx = 0, xy = 0, yy = 0;
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 axis = axes[k] * g.scales[i][k];
      const float u = across * axis.x + along_x * axis.z, v = up * axis.y + along_y * axis.z;
      xx += u * u;
      xy += u * v;
      yy += v * v;
    }
    const float sharp = xx * yy - xy * xy;
    xx += kGaussianLowPass;
    yy += kGaussianLowPass;
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 0) || !std::isfinite(determinant)) continue;
    if (g.antialiased) opacity *= std::sqrt(std::max(sharp, 0.0f) / determinant);
    if (!(opacity >= kGaussianLeastAlpha)) continue;
    GaussianSplat splat;
    splat.peak = std::log2(std::min(opacity, 1.0f));
    // The opacity falls to the minimum where half the squared Mahalanobis distance is `inside`.
    const float inside = 2 * std::log(std::min(opacity, 1.0f) / kGaussianLeastAlpha);
    splat.reach_x = std::sqrt(inside * xx);
    splat.reach_y = std::sqrt(inside * yy);
    if (!(splat.reach_x < kGaussianMostReach && splat.reach_y < kGaussianMostReach)) continue;
    splat.x = seen.x * across + lens->middle_x - 0.5f;
    splat.y = seen.y * up + lens->middle_y - 0.5f;
    if (!(splat.x + splat.reach_x >= 0 && splat.y + splat.reach_y >= 0)) continue;
    if (!(splat.x - splat.reach_x <= static_cast<float>(lens->width - 1)) ||
        !(splat.y - splat.reach_y <= static_cast<float>(lens->height - 1)))
      continue;
    const float factor = 0.5f * kLog2E / determinant;
    splat.xx = yy * factor;
    splat.xy = -xy * factor;
    splat.yy = xx * factor;
    const glm::vec3 away = position - eye;
    const float distance = glm::dot(seen, seen), length = std::sqrt(glm::dot(away, away));
    glm::vec3 color = gaussian_color(g.bases[i], per == 0 ? nullptr : g.harmonics.data() + i * per,
                                     length > 0 ? g.degree : 0, length > 0 ? away / length : away);
    if (item.fog.on) color = fogged(item.fog, color, seen);
    splat.red = color.x;
    splat.green = color.y;
    splat.blue = color.z;
    splat.depth = splat.least_depth = depth;
    if (!std::isfinite(color.x + color.y + color.z) || !std::isfinite(distance)) continue;
    splats.push_back(splat);
    distances.push_back(distance);
  }
}

}  // namespace gs::render
