#include "render/gaussians/gaussian_ellipse.h"
#include "render/gaussians/gaussian_harmonics.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/volume/volume_lens.h"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

namespace gs::render {
namespace {

// Minimum distance of a surfel from the plane of the eye, relative to the depth of its centre.
constexpr float kSurfelMargin = 1e-2f;

/// Surfel in camera space.
struct SeenSurfel {
  glm::vec3 place;  // position of the centre
  glm::vec3 u, v;   // standard deviations along its axes
  float opacity;
};

/// Returns the lens for an item's splats.
GaussianLens lens_of(const VolumeLens& lens, const SplatView& view, bool antialiased) {
  GaussianLens made{};
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 3; ++row)
      made.camera_from_node[column][row] =
          lens.camera_from_node[static_cast<glm::length_t>(column)][static_cast<glm::length_t>(row)];
  made.pixels_x = lens.pixels_x;
  made.pixels_y = lens.pixels_y;
  made.middle_x = lens.middle_x;
  made.middle_y = lens.middle_y;
  made.left = view.center.x - kGaussianFarthestTangent * view.tangents.x;
  made.right = view.center.x + kGaussianFarthestTangent * view.tangents.x;
  made.bottom = view.center.y - kGaussianFarthestTangent * view.tangents.y;
  made.top = view.center.y + kGaussianFarthestTangent * view.tangents.y;
  made.last_x = static_cast<float>(lens.width - 1);
  made.last_y = static_cast<float>(lens.height - 1);
  made.near_plane = view.near_plane;
  made.antialiased = antialiased;
  return made;
}

/// Sets the shape, opacity, pixel and box of a surfel. Returns false if the surfel reaches the plane of the eye.
bool shape_surfel(const GaussianLens& lens, const SeenSurfel& seen, GaussianSplat& splat, GaussianSurfel& surfel) {
  // A point (u, v) of the plane has the depth dot(depth, (u, v, 1)), and dot(x, ...) / dot(depth, ...) is its
  // distance from the centre in pixels.
  const float near = -1 / seen.place.z;
  const glm::vec3 depth(-seen.u.z, -seen.v.z, -seen.place.z);
  const glm::vec3 x = lens.pixels_x * (glm::vec3(seen.u.x, seen.v.x, seen.place.x) - seen.place.x * near * depth),
                  y = lens.pixels_y * (glm::vec3(seen.u.y, seen.v.y, seen.place.y) - seen.place.y * near * depth);
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
  const float reach_x = extent(x), reach_y = extent(y);
  if (!(reach_x < kGaussianMostReach && reach_y < kGaussianMostReach)) return false;
  splat.x = seen.place.x * lens.pixels_x * near + lens.middle_x - 0.5f;
  splat.y = seen.place.y * lens.pixels_y * near + lens.middle_y - 0.5f;
  splat.left = splat.x - reach_x;
  splat.right = splat.x + reach_x;
  splat.bottom = splat.y - reach_y;
  splat.top = splat.y + reach_y;
  splat.xx = splat.yy = 1;
  splat.xy = 0;
  // The ray of a pixel is the intersection of the planes through its column and its row.
  glm::mat3 lines(glm::cross(y, depth), glm::cross(depth, x), glm::cross(x, y));
  float most = 0;
  for (int k = 0; k < 3; ++k) most = std::max({most, std::abs(lines[k].x), std::abs(lines[k].y), std::abs(lines[k].z)});
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

bool is_in_view(const GaussianLens& lens, const GaussianSplat& splat) {
  return splat.right >= 0 && splat.top >= 0 && splat.left <= lens.last_x && splat.bottom <= lens.last_y;
}

/// Reads eight splats of an item from index `first` on. Splats from `end` on and clipped splats get the opacity 0. Uses
/// pointers, because the standard library would check each index.
void read_eight(const GaussianItem& item, std::size_t first, std::size_t end, EightGaussians& eight) {
  const qnv::Gaussians& g = *item.gaussians;
  const glm::vec3 *const positions = g.positions.data(), *const scales = g.scales.data();
  const glm::vec4* const rotations = g.rotations.data();
  const float* const opacities = g.opacities.data();
  const std::size_t count = std::min(EightGaussians::kLanes, end - first);
  for (std::size_t k = 0; k < EightGaussians::kLanes; ++k) {
    const std::size_t i = first + std::min(k, count - 1);
    eight.position_x.data()[k] = positions[i].x;
    eight.position_y.data()[k] = positions[i].y;
    eight.position_z.data()[k] = positions[i].z;
    eight.scale_x.data()[k] = scales[i].x;
    eight.scale_y.data()[k] = scales[i].y;
    eight.scale_z.data()[k] = scales[i].z;
    eight.rotation_x.data()[k] = rotations[i].x;
    eight.rotation_y.data()[k] = rotations[i].y;
    eight.rotation_z.data()[k] = rotations[i].z;
    eight.rotation_w.data()[k] = rotations[i].w;
    eight.opacity.data()[k] = opacities[i] * item.opacity;
  }
  if (item.presence < 1)
    for (float& opacity : eight.opacity) opacity = faded_opacity(opacity, item.presence);
  if (item.clip)
    for (std::size_t k = 0; k < count; ++k)
      if (!(glm::dot(glm::vec3(*item.clip), positions[first + k]) + item.clip->w >= 0)) eight.opacity[k] = 0;
  for (std::size_t k = count; k < EightGaussians::kLanes; ++k) eight.opacity[k] = 0;
}

}  // namespace

void project_gaussians(const GaussianItem& item, const SplatView& view, std::size_t first, std::size_t last,
                       ProjectedGaussians& out) {
  const std::optional<VolumeLens> lens = volume_lens(view, item.camera_from_node);
  if (!lens || !item.gaussians) return;
  const qnv::Gaussians& g = *item.gaussians;
  const GaussianLens view_lens = lens_of(*lens, view, g.antialiased);
  const GaussianEllipses ellipses = gaussian_ellipses();
  const glm::mat3 linear(item.camera_from_node);
  const glm::vec3 eye = glm::inverse(linear) * -glm::vec3(item.camera_from_node[3]);
  const std::size_t start = std::min(item.first, g.size()),
                    end = start + std::min({last, item.count, g.size() - start}), per = qnv::harmonic_count(g.degree);
  EightGaussians eight;
  for (std::size_t begin = start + first; begin < end; begin += EightGaussians::kLanes) {
    read_eight(item, begin, end, eight);
    ellipses(view_lens, eight);
    for (std::uint32_t placed = eight.placed; placed != 0; placed &= placed - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(placed));
      const std::size_t i = begin + k;
      const glm::vec3 seen(eight.seen_x.data()[k], eight.seen_y.data()[k], eight.seen_z.data()[k]);
      GaussianSplat surfel_splat;
      GaussianSurfel surfel;
      const glm::vec3& scales = g.scales.data()[i];
      bool flat = scales.z == 0 && scales.x > 0 && scales.y > 0;
      if (flat) {
        const glm::vec4& q = g.rotations[i];
        const glm::mat3 axes = linear * glm::mat3_cast(glm::quat(q.w, q.x, q.y, q.z));
        flat = shape_surfel(view_lens, {seen, axes[0] * scales.x, axes[1] * scales.y, eight.opacity[k]}, surfel_splat,
                            surfel);
        if (flat && !is_in_view(view_lens, surfel_splat)) continue;
      }
      if (!flat && (eight.visible >> k & 1) == 0) continue;
      const glm::vec3* const harmonics = per == 0 ? nullptr : g.harmonics.data() + i * per;
      glm::vec3 away(0), color;
      float length = 0;
      if (harmonics) {
        away = g.positions.data()[i] - eye;
        length = std::sqrt(glm::dot(away, away));
      }
      color =
          gaussian_color(g.bases.data()[i], harmonics, length > 0 ? g.degree : 0, length > 0 ? away / length : away);
      if (item.fog.on) color = fogged(item.fog, color, seen);
      if (!std::isfinite(color.x + color.y + color.z)) continue;
      // Writes the splat in place, because a copy of new fields from the stack would wait for their stores.
      GaussianSplat& splat = out.splats.emplace_back();
      if (flat) {
        splat = surfel_splat;
        splat.surfel = static_cast<std::int32_t>(out.surfels.size());
        out.surfels.push_back(surfel);
      } else {
        splat.x = eight.x.data()[k];
        splat.y = eight.y.data()[k];
        splat.xx = eight.xx.data()[k];
        splat.xy = eight.xy.data()[k];
        splat.yy = eight.yy.data()[k];
        splat.peak = eight.peak.data()[k];
        splat.left = eight.left.data()[k];
        splat.right = eight.right.data()[k];
        splat.bottom = eight.bottom.data()[k];
        splat.top = eight.top.data()[k];
        splat.surfel = -1;
      }
      splat.red = color.x;
      splat.green = color.y;
      splat.blue = color.z;
      splat.depth = splat.least_depth = -seen.z;
      out.distances.push_back(eight.distance.data()[k]);
    }
  }
}

}  // namespace gs::render
