#include "render/gaussians/gaussian_harmonics.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/volume/volume_lens.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace gs::render {
namespace {

constexpr float kLog2E = 1.44269504f;
// Minimum distance of a surfel from the plane of the eye, relative to the depth of its centre.
constexpr float kSurfelMargin = 1e-2f;

/// Splat in camera space.
struct SeenGaussian {
  glm::vec3 place;  // of the centre
  glm::mat3 axes;   // directions of its axes; the length of each is a unit of the node
  glm::vec3 scales;
  float opacity;
};

/// Projection of splats of one view.
class GaussianProjection {
 public:
  GaussianProjection(const VolumeLens& lens, const SplatView& view)
      : lens_(lens),
        left_(view.center.x - kGaussianFarthestTangent * view.tangents.x),
        right_(view.center.x + kGaussianFarthestTangent * view.tangents.x),
        low_(view.center.y - kGaussianFarthestTangent * view.tangents.y),
        high_(view.center.y + kGaussianFarthestTangent * view.tangents.y) {}

  /// Sets shape and opacity, and the half extents of the ellipse, by EWA. Returns false if the splat is invisible.
  [[nodiscard]] bool shape_ellipse(const SeenGaussian& seen, bool antialiased, GaussianSplat& splat,
                                   glm::vec2& reach) const {
    const float near = -1 / seen.place.z, across = lens_.pixels_x * near, up = lens_.pixels_y * near;
    // J at the centre: the change of the pixel with the camera-space position.
    const float along_x = across * std::clamp(seen.place.x * near, left_, right_),
                along_y = up * std::clamp(seen.place.y * near, low_, high_);
    float xx = 0, xy = 0, yy = 0;
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 axis = seen.axes[k] * seen.scales[k];
      const float u = across * axis.x + along_x * axis.z, v = up * axis.y + along_y * axis.z;
      xx += u * u;
      xy += u * v;
      yy += v * v;
    }
    const float sharp = xx * yy - xy * xy;
    xx += kGaussianLowPass;
    yy += kGaussianLowPass;
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 0) || !std::isfinite(determinant)) return false;
    float opacity = seen.opacity;
    if (antialiased) opacity *= std::sqrt(std::max(sharp, 0.0f) / determinant);
    if (!(opacity >= kGaussianLeastAlpha)) return false;
    splat.peak = std::log2(std::min(opacity, 1.0f));
    // The opacity falls to the minimum where half the squared Mahalanobis distance is `inside`.
    const float inside = 2 * std::log(std::min(opacity, 1.0f) / kGaussianLeastAlpha);
    reach = {std::sqrt(inside * xx), std::sqrt(inside * yy)};
    const float factor = 0.5f * kLog2E / determinant;
    splat.xx = yy * factor;
    splat.xy = -xy * factor;
    splat.yy = xx * factor;
    return true;
  }

  /// Sets opacity, half extents and linear functions of a surfel. Returns false if the surfel reaches the plane of the
  /// eye.
  [[nodiscard]] bool shape_surfel(const SeenGaussian& seen, GaussianSplat& splat, GaussianSurfel& surfel,
                                  glm::vec2& reach) const {
    const glm::vec3 u = seen.axes[0] * seen.scales.x, v = seen.axes[1] * seen.scales.y;
    // A point (u, v) of the plane has the depth dot(depth, (u, v, 1)), and dot(x, ...) / dot(depth, ...) is its
    // distance from the centre in pixels.
    const float near = -1 / seen.place.z;
    const glm::vec3 depth(-u.z, -v.z, -seen.place.z);
    const glm::vec3 x = lens_.pixels_x * (glm::vec3(u.x, v.x, seen.place.x) - seen.place.x * near * depth),
                    y = lens_.pixels_y * (glm::vec3(u.y, v.y, seen.place.y) - seen.place.y * near * depth);
    const float opacity = std::min(seen.opacity, 1.0f), inside = 2 * std::log(opacity / kGaussianLeastAlpha);
    const float across = inside * (depth.x * depth.x + depth.y * depth.y), square = depth.z * depth.z;
    if (!(across < square * (1 - kSurfelMargin))) return false;
    splat.peak = std::log2(opacity);
    // The outline u^2 + v^2 = inside is an ellipse; its extent follows from its dual conic.
    const float scale = inside / (across - square), least = std::sqrt(inside / kSurfelScreen);
    const auto extent = [&](const glm::vec3& row) {
      const float middle = scale * (row.x * depth.x + row.y * depth.y);
      return std::max(std::abs(middle) + std::sqrt(middle * middle - scale * (row.x * row.x + row.y * row.y)), least);
    };
    reach = {extent(x), extent(y)};
    splat.xx = splat.yy = 1;
    splat.xy = 0;
    // The ray of a pixel is the intersection of the planes through its column and its row.
    glm::mat3 lines(glm::cross(y, depth), glm::cross(depth, x), glm::cross(x, y));
    float most = 0;
    for (int k = 0; k < 3; ++k)
      most = std::max({most, std::abs(lines[k].x), std::abs(lines[k].y), std::abs(lines[k].z)});
    if (!(most > 0) || !std::isfinite(most)) return false;
    lines /= most;
    for (int k = 0; k < 3; ++k) {
      const auto to = static_cast<std::size_t>(k);
      surfel.a[to] = lines[k].x;
      surfel.b[to] = lines[k].y;
      surfel.c[to] = lines[k].z;
    }
    return true;
  }

  /// Sets the pixel of the centre and the box. Returns false if the splat is out of view.
  [[nodiscard]] bool place(const glm::vec3& seen, const glm::vec2& reach, GaussianSplat& splat) const {
    if (!(reach.x < kGaussianMostReach && reach.y < kGaussianMostReach)) return false;
    const float near = -1 / seen.z;
    splat.x = seen.x * lens_.pixels_x * near + lens_.middle_x - 0.5f;
    splat.y = seen.y * lens_.pixels_y * near + lens_.middle_y - 0.5f;
    splat.left = splat.x - reach.x;
    splat.right = splat.x + reach.x;
    splat.bottom = splat.y - reach.y;
    splat.top = splat.y + reach.y;
    return splat.right >= 0 && splat.top >= 0 && splat.left <= static_cast<float>(lens_.width - 1) &&
           splat.bottom <= static_cast<float>(lens_.height - 1);
  }

 private:
  const VolumeLens& lens_;
  float left_, right_, low_, high_;
};

}  // namespace

void project_gaussians(const GaussianItem& item, const SplatView& view, std::size_t first, std::size_t last,
                       ProjectedGaussians& out) {
  const std::optional<VolumeLens> lens = volume_lens(view, item.camera_from_node);
  if (!lens || !item.gaussians) return;
  const qnv::Gaussians& g = *item.gaussians;
  const GaussianProjection projection(*lens, view);
  const glm::mat3 linear(item.camera_from_node);
  const glm::vec3 eye = glm::inverse(linear) * -glm::vec3(item.camera_from_node[3]);
  const std::size_t start = std::min(item.first, g.size()),
                    end = start + std::min({last, item.count, g.size() - start}), per = qnv::harmonic_count(g.degree);
  for (std::size_t i = start + first; i < end; ++i) {
    const glm::vec3& position = g.positions[i];
    SeenGaussian seen;
    seen.place = glm::vec3(item.camera_from_node * glm::vec4(position, 1.0f));
    const float depth = -seen.place.z;
    if (!(depth > view.near_plane && depth > 0)) continue;
    seen.opacity = faded_opacity(g.opacities[i] * item.opacity, item.presence);
    if (!(seen.opacity >= kGaussianLeastAlpha)) continue;
    if (item.clip && !(glm::dot(glm::vec3(*item.clip), position) + item.clip->w >= 0)) continue;
    const glm::vec4& q = g.rotations[i];
    seen.axes = linear * glm::mat3_cast(glm::quat(q.w, q.x, q.y, q.z));
    seen.scales = g.scales[i];
    GaussianSplat splat;
    GaussianSurfel surfel;
    glm::vec2 reach;
    const bool flat = seen.scales.z == 0 && seen.scales.x > 0 && seen.scales.y > 0 &&
                      projection.shape_surfel(seen, splat, surfel, reach);
    if (!flat && !projection.shape_ellipse(seen, g.antialiased, splat, reach)) continue;
    if (!projection.place(seen.place, reach, splat)) continue;
    const glm::vec3 away = position - eye;
    const float distance = glm::dot(seen.place, seen.place), length = std::sqrt(glm::dot(away, away));
    glm::vec3 color = gaussian_color(g.bases[i], per == 0 ? nullptr : g.harmonics.data() + i * per,
                                     length > 0 ? g.degree : 0, length > 0 ? away / length : away);
    if (item.fog.on) color = fogged(item.fog, color, seen.place);
    splat.red = color.x;
    splat.green = color.y;
    splat.blue = color.z;
    splat.depth = splat.least_depth = depth;
    if (!std::isfinite(color.x + color.y + color.z) || !std::isfinite(distance)) continue;
    if (flat) {
      splat.surfel = static_cast<std::int32_t>(out.surfels.size());
      out.surfels.push_back(surfel);
    }
    out.splats.push_back(splat);
    out.distances.push_back(distance);
  }
}

}  // namespace gs::render
