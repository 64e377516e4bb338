#include "render/rays/splat_pick.h"

#include "base/finite.h"
#include "base/parallel.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "render/rays/gaussian_pick.h"
#include "render/splat/software/splat_constants.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace gs::render {
namespace {

constexpr std::size_t kPickedRange = 65536;  // vectors per task
constexpr std::size_t kPickedBlock = 256;    // vectors that are tested together
constexpr float kDiagonal = 1.7321f;         // diagonal of a cube with edge 1
constexpr float kBeam = 4;                   // half width in pixels of the beam around the ray in which the cut is fine
constexpr float kMinOpacity = 0.01f;         // minimum opacity of a volume that can be hit
constexpr float kVolumeReach = 4.5f;         // square of the distance, in spacings, beyond which opacity is negligible
constexpr float kMinDeterminant = 1e-30f;

/// Ray in the space of a geometry.
struct NodeRay {
  glm::vec3 origin, direction;  // `direction` is one world unit long
  glm::vec3 across, up;         // unit vectors, orthogonal to `direction` and to each other
  float along = 0;              // `along` * dot(p - origin, direction) is the distance of a point p, in node units
  float sample = 0;             // in node units: width of a pixel at distance 1
  float farthest = 0;
};

glm::vec3 any_perpendicular(const glm::vec3& unit) {
  const glm::vec3 other = std::abs(unit.x) < 0.6f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  return glm::normalize(glm::cross(unit, other));
}

std::optional<NodeRay> in_node(const PickRay& ray, const glm::dmat4& world_from_node) {
  const glm::dmat3 linear(world_from_node);
  const double determinant = glm::determinant(linear);
  if (!(std::abs(determinant) > static_cast<double>(kMinDeterminant)) || !std::isfinite(determinant))
    return std::nullopt;
  const glm::dmat3 inverse = glm::inverse(linear);
  NodeRay node;
  node.origin = glm::vec3(inverse * (ray.origin - glm::dvec3(world_from_node[3])));
  node.direction = glm::vec3(inverse * glm::dvec3(ray.direction));
  const float length = std::sqrt(glm::dot(node.direction, node.direction));
  if (!finite(node.origin) || !finite(node.direction) || !(length > 0) || !std::isfinite(1 / length))
    return std::nullopt;
  const glm::vec3 unit = node.direction / length;
  node.across = any_perpendicular(unit);
  node.up = glm::cross(unit, node.across);
  node.along = 1 / (length * length);
  double scale = 0;
  for (int i = 0; i < 3; ++i) scale = std::max(scale, glm::length(linear[i]));
  node.sample = std::max(ray.pixel, 0.0f) / static_cast<float>(scale);
  node.farthest = ray.farthest;
  return node;
}

/// Finds the nearest splat that a ray hits, in a range of a geometry.
class DiscPicker {
 public:
  DiscPicker(const qnv::Splats& splats, float growth, bool two_sided, const NodeRay& ray)
      : splats_(splats), growth_(growth), two_sided_(two_sided), ray_(ray) {}

  /// Returns the nearest hit if it is nearer than `nearest`. Otherwise returns `nearest`.
  [[nodiscard]] DiscPick run(std::size_t first, std::size_t last, DiscPick nearest) const {
    splats_.cells.empty() ? discs(first, last, nearest) : cubes(first, last, nearest);
    return nearest;
  }

 private:
  // Finds hits on splats without cubes. A quick test rejects nearly all splats without unpredictable branches: the ray
  // must pass the centre within the splat's reach.
  void discs(std::size_t first, std::size_t last, DiscPick& nearest) const {
    const glm::vec3* positions = splats_.positions.data();
    const float* weights = splats_.weights.data();
    const float cover2 = growth_ * (splat::kDiscCover * splat::kDiscCover / splat::kPi),
                least = ray_.sample * splat::kMinReach;
    const glm::vec3 origin = ray_.origin, across = ray_.across, up = ray_.up,
                    forward = ray_.direction * (ray_.along * least);
    std::array<float, kPickedBlock> outside;  // positive if the ray misses the splat
    for (std::size_t begin = first; begin < last; begin += kPickedBlock) {
      const std::size_t count = std::min(kPickedBlock, last - begin);
      for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 off = positions[begin + i] - origin;
        const float x = off.x * across.x + off.y * across.y + off.z * across.z;
        const float y = off.x * up.x + off.y * up.y + off.z * up.z;
        const float small = off.x * forward.x + off.y * forward.y + off.z * forward.z;
        const float away2 = x * x + y * y, a = away2 - weights[begin + i] * cover2, b = away2 - small * small;
        outside[i] = a < b ? a : b;
      }
      for (std::size_t i = 0; i < count; ++i)
        if (!(outside[i] > 0)) exact(begin + i, nearest);
    }
  }

  void cubes(std::size_t first, std::size_t last, DiscPick& nearest) const {
    const glm::vec3* positions = splats_.positions.data();
    const float* weights = splats_.weights.data();
    const qnv::Cell* cells = splats_.cells.data();
    const float cover = std::sqrt(growth_ / splat::kPi) * splat::kDiscCover;
    const glm::vec3 forward = ray_.direction * ray_.along;
    for (std::size_t i = first; i < last; ++i) {
      const glm::vec3 off = positions[i] - ray_.origin;
      const float x = glm::dot(off, ray_.across), y = glm::dot(off, ray_.up);
      const float sample = std::abs(glm::dot(off, forward)) * ray_.sample;
      const float half =
          cells[i].edge > 0 ? cells[i].edge * (0.5f + splat::kCubeMargin) : cover * std::sqrt(weights[i]);
      const float reach = kDiagonal * (half + splat::kMinReach * sample) + std::abs(cells[i].offset);
      if (x * x + y * y > reach * reach) continue;
      exact(i, nearest);
    }
  }

  /// Tests a splat exactly, by the definition in tests/render/rays/raycast.h.
  void exact(std::size_t i, DiscPick& nearest) const {
    const glm::vec3 place = splats_.positions[i] - ray_.origin;
    const glm::vec3& normal = splats_.normals[i];
    const float plane = glm::dot(normal, place);
    if (plane > 0 && !two_sided_) return;
    if (!(plane * plane > splat::kGrazing * splat::kGrazing * glm::dot(place, place))) return;
    const float distance = plane / glm::dot(normal, ray_.direction);
    if (!(distance > 0 && distance < nearest.distance)) return;
    const float radius = std::sqrt(splats_.weights[i] * growth_ * (1 / splat::kPi));
    const float sample = std::max(glm::dot(place, ray_.direction) * ray_.along, 0.0f) * ray_.sample;
    const bool cell = !splats_.cells.empty() && splats_.cells[i].edge > 0;
    float reach = std::max(radius * splat::kDiscCover, sample * splat::kMinReach);
    glm::vec3 off = ray_.direction * distance - place;
    if (cell) {
      const qnv::Cell& cube = splats_.cells[i];
      off += normal * cube.offset;
      const float margin = plane > 0 ? cube.edge * splat::kBackMargin
                                     : std::max(cube.edge * splat::kCubeMargin, sample * splat::kSampleMargin);
      reach = std::max(cube.edge * 0.5f + margin, sample * splat::kMinReach);
    }
    // A splat with a size that is not finite is not drawn.
    if (!(radius > 0 && std::isfinite(radius) && std::isfinite(reach))) return;
    const bool hit = splats_.cells.empty() ? glm::dot(off, off) < reach * reach
                                           : std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) < reach;
    if (!hit) return;
    nearest.distance = distance;
    nearest.color = splats_.colors.size() == splats_.size() ? std::optional(splats_.colors[i]) : std::nullopt;
  }

  const qnv::Splats& splats_;
  float growth_;
  bool two_sided_;
  const NodeRay& ray_;
};

template <class Vectors>
bool can_be_picked(const Vectors& vectors) {
  return vectors.normals.size() == vectors.size() && vectors.weights.size() == vectors.size() &&
         (vectors.cells.empty() || vectors.cells.size() == vectors.size());
}

/// Returns a thin pyramid around the ray. A cut for it is as fine as in the image.
qnv::LodView view_along(const PickRay& ray, const glm::dmat4& world_from_node, const NodeRay& node,
                        std::size_t budget) {
  qnv::LodView view;
  view.eye = node.origin;
  view.pixels = 1 / std::clamp(ray.pixel, 1e-6f, 1.0f);
  view.budget = budget;
  view.viewport = kPickViewport;
  const glm::dmat4 transposed = glm::transpose(world_from_node);
  const glm::vec3 across = any_perpendicular(ray.direction), up = glm::cross(ray.direction, across);
  const glm::vec3 ahead = ray.direction * (kBeam / view.pixels);
  const std::array<glm::vec3, 5> inwards{ahead + across, ahead - across, ahead + up, ahead - up, ray.direction};
  for (std::size_t i = 0; i < inwards.size(); ++i)
    view.planes[i] = glm::vec4(transposed * glm::dvec4(inwards[i], -glm::dot(glm::dvec3(inwards[i]), ray.origin)));
  return view;
}

/// Effect of one volume vector on the ray.
struct Veil {
  float depth, alpha;
};

/// Finds the volume vectors near a ray, in a range of a geometry.
class VeilFinder {
 public:
  VeilFinder(const qnv::Volume& volume, const VolumeModel& model, const VolumeOptions& options,
             const glm::dmat4& world_from_node, const PickRay& ray)
      : volume_(volume), model_(model), options_(options), pixel_(ray.pixel), farthest_(ray.farthest) {
    const glm::dmat3 linear(world_from_node), transposed = glm::transpose(linear);
    const double determinant = glm::determinant(linear);
    usable_ = std::abs(determinant) > static_cast<double>(kMinDeterminant) && std::isfinite(determinant);
    scale_ = static_cast<float>(std::cbrt(std::abs(determinant)));
    const glm::vec3 across = any_perpendicular(ray.direction), up = glm::cross(ray.direction, across);
    // Rows that transform a position from node space to world units relative to the ray.
    const glm::dvec3 from = glm::dvec3(world_from_node[3]) - ray.origin;
    const auto row = [&](const glm::vec3& axis) {
      return glm::vec4(glm::vec3(transposed * glm::dvec3(axis)), static_cast<float>(glm::dot(glm::dvec3(axis), from)));
    };
    across_ = row(across);
    up_ = row(up);
    forward_ = row(ray.direction);
  }

  [[nodiscard]] bool usable() const { return usable_; }

  void run(std::size_t first, std::size_t last, std::vector<Veil>& out) const {
    const float reach2 = kVolumeReach * scale_ * scale_, least2 = kVolumeReach * kVolumePixel * pixel_ * pixel_;
    for (std::size_t k = first; k < last; ++k) {
      const glm::vec4 p(volume_.positions[k], 1);
      const float x = glm::dot(p, across_), y = glm::dot(p, up_), depth = glm::dot(p, forward_);
      const float away2 = x * x + y * y, spacing = model_.spacing[k];
      if (!(away2 < spacing * spacing * reach2 || away2 < depth * depth * least2)) continue;
      float alpha = volume_alpha(volume_, model_, options_, k),
            area = kVolumeFootprint * spacing * spacing * scale_ * scale_;
      if (!(alpha > 0 && depth > spacing * scale_ && depth < farthest_)) continue;
      const float least = kVolumePixel * depth * depth * pixel_ * pixel_;
      if (area < least) {
        alpha *= area / least;
        area = least;
      }
      alpha *= std::exp(-away2 / area);
      if (alpha > 0) out.push_back({depth, alpha});
    }
  }

 private:
  const qnv::Volume& volume_;
  const VolumeModel& model_;
  const VolumeOptions& options_;
  float pixel_, farthest_, scale_ = 0;
  bool usable_ = false;
  glm::vec4 across_{0}, up_{0}, forward_{0};
};

/// Returns the depth at which the share `taken` of the light is absorbed. `veils` must be sorted by depth.
float depth_where(const std::vector<Veil>& veils, float taken) {
  float clear = 1;
  for (const Veil& veil : veils) {
    clear *= 1 - veil.alpha;
    if (1 - clear >= taken) return veil.depth;
  }
  return veils.back().depth;
}

}  // namespace

std::optional<DiscPick> pick_disc(const qnv::Geometry& geometry, const glm::dmat4& world_from_node, const PickRay& ray,
                                  const PickLimits& limits) {
  const auto* const gaussians = geometry.as<qnv::Gaussians>();
  if (gaussians && !gaussians->stream) return pick_gaussians(*gaussians, world_from_node, ray, limits);
  const std::optional<NodeRay> node = in_node(ray, world_from_node);
  if (!node) return std::nullopt;
  if (gaussians) {
    std::vector<GaussianPart> parts;
    const std::vector<qnv::SplatRun> runs =
        gaussians->stream->cut(view_along(ray, world_from_node, *node, limits.level_vectors));
    gaussians->stream->forget(kPickViewport);  // the next ray may be elsewhere, so keep no cut
    for (const qnv::SplatRun& run : runs) parts.push_back({run.splats.get(), run.first, run.count});
    return pick_gaussians(parts, world_from_node, ray, limits);
  }
  DiscPick nearest{node->farthest, std::nullopt};
  if (const auto* octree = geometry.as<qnv::OctreeSplats>()) {
    const qnv::LodView view = view_along(ray, world_from_node, *node, limits.level_vectors);
    const std::vector<qnv::Piece> pieces = octree->stream->cut(view);
    octree->stream->forget(kPickViewport);  // the next ray may be elsewhere, so keep no cut
    for (const qnv::Piece& piece : pieces) {
      if (!can_be_picked(*piece.splats)) continue;
      const DiscPicker picker(*piece.splats, 1, piece.splats->description.two_sided, *node);
      nearest = picker.run(piece.first, piece.first + piece.count, nearest);
    }
  } else if (const auto* splats = geometry.as<qnv::Splats>(); splats && can_be_picked(*splats) && !splats->empty()) {
    const std::size_t count = std::min(splats->size(), std::max<std::size_t>(limits.vectors, 1));
    const float growth = static_cast<float>(splats->size()) / static_cast<float>(count);
    const DiscPicker picker(*splats, growth, splats->description.two_sided, *node);
    std::vector<DiscPick> found((count + kPickedRange - 1) / kPickedRange, nearest);
    parallel_for(
        found.size(),
        [&](std::size_t r) {
          found[r] = picker.run(r * kPickedRange, std::min(count, (r + 1) * kPickedRange), nearest);
        },
        count > kPickedRange ? limits.threads : 1);
    for (const DiscPick& one : found)
      if (one.distance < nearest.distance) nearest = one;
  }
  return nearest.distance < node->farthest ? std::optional(nearest) : std::nullopt;
}

std::optional<VolumePick> pick_volume(const qnv::Volume& volume, const VolumeModel& model, const VolumeOptions& options,
                                      const glm::dmat4& world_from_node, const PickRay& ray, const PickLimits& limits) {
  const VeilFinder finder(volume, model, options, world_from_node, ray);
  const bool fits = can_be_picked(volume) && model.spacing.size() == volume.size() &&
                    (volume.classes.empty() || volume.classes.size() == volume.size());
  if (!finder.usable() || !fits || volume.empty()) return std::nullopt;
  const std::size_t count = std::min(volume.size(), limits.vectors);
  std::vector<std::vector<Veil>> found((count + kPickedRange - 1) / kPickedRange);
  parallel_for(
      found.size(),
      [&](std::size_t r) { finder.run(r * kPickedRange, std::min(count, (r + 1) * kPickedRange), found[r]); },
      count > kPickedRange ? limits.threads : 1);
  std::vector<Veil> veils;
  for (const std::vector<Veil>& part : found) veils.insert(veils.end(), part.begin(), part.end());
  std::stable_sort(veils.begin(), veils.end(), [](const Veil& a, const Veil& b) { return a.depth < b.depth; });
  float clear = 1;
  for (const Veil& veil : veils) clear *= 1 - veil.alpha;
  const float opacity = 1 - clear;
  if (!(opacity >= kMinOpacity)) return std::nullopt;
  return VolumePick{depth_where(veils, opacity >= 0.5f ? 0.5f : 0.5f * opacity), opacity};
}

}  // namespace gs::render
