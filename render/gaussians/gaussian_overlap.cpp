#include "render/gaussians/gaussian_overlap.h"

#include "render/collection/collector.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace gs::render {
namespace {

constexpr std::size_t kMostSampled = 65536;
constexpr std::size_t kMostTested = std::size_t{1} << 22;  // pairs of a sampled centre and a volume
constexpr float kSlabPixels = 16;  // pixels of the shared region, along its longer side, per slab

/// Returns the bounds of a geometry in world space. Returns empty bounds if it has other content, or no box.
template <class Content>
WideBox bounds_of(const SplatItem& item) {
  if (!item.geometry || !item.geometry->as<Content>() || item.geometry->description().box.empty()) return {};
  return world_bounds(item.geometry->description().box, item.world_from_node);
}

template <class Content>
WideBox bounds_of_all(const RenderList& list) {
  WideBox bounds;
  for (const SplatItem& item : list.splats)
    if (const WideBox own = bounds_of<Content>(item); !own.empty()) bounds.add(own);
  return bounds;
}

/// Region that Gaussians and volumes share: pixels of the picture, and depths.
struct SharedRegion {
  glm::vec2 lower{std::numeric_limits<float>::max()}, upper{std::numeric_limits<float>::lowest()};
  DepthRange depths{std::numeric_limits<float>::max(), 0};

  /// Adds a centre in camera space, if it is in view.
  void add(const glm::vec3& seen, const SplatView& view) {
    const float depth = -seen.z;
    if (!(depth > view.near_plane)) return;
    const glm::vec2 place = (glm::vec2(seen) / depth - view.center) / view.tangents;
    if (!(std::abs(place.x) <= 1 && std::abs(place.y) <= 1)) return;
    const glm::vec2 pixel = place * 0.5f * glm::vec2(view.width, view.height);
    lower = glm::min(lower, pixel);
    upper = glm::max(upper, pixel);
    depths = {std::min(depths.nearest, depth), std::max(depths.farthest, depth)};
  }
};

}  // namespace

bool are_gaussians_behind_volumes(const RenderList& list, const glm::dvec3& eye) {
  const WideBox volumes = bounds_of_all<qnv::Volume>(list), gaussians = bounds_of_all<qnv::Gaussians>(list);
  if (volumes.empty() || gaussians.empty()) return false;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool above : {false, true}) {  // whether the volumes are on the upper side
      const double low = above ? gaussians.upper[axis] : volumes.upper[axis],
                   high = above ? volumes.lower[axis] : gaussians.lower[axis];
      if (low > high) continue;
      // If the eye is between the boxes, neither box hides the other along this axis.
      if (eye[axis] <= low || eye[axis] >= high) return (eye[axis] >= high) == above;
    }
  const auto distance = [&](const WideBox& box) { return glm::distance(eye, (box.lower + box.upper) * 0.5); };
  return distance(volumes) < distance(gaussians);
}

bool do_boxes_of_gaussians_and_volumes_overlap(const RenderList& list) {
  std::vector<WideBox> volumes;
  for (const SplatItem& item : list.splats)
    if (const WideBox own = bounds_of<qnv::Volume>(item); !own.empty()) volumes.push_back(own);
  return std::ranges::any_of(list.splats, [&](const SplatItem& item) {
    if (volumes.empty()) return false;
    const WideBox own = bounds_of<qnv::Gaussians>(item);
    return !own.empty() && std::ranges::any_of(volumes, [&](const WideBox& volume) {
      return glm::all(glm::lessThan(glm::max(volume.lower, own.lower), glm::min(volume.upper, own.upper)));
    });
  });
}

std::vector<VolumeBox> volume_boxes(const RenderList& list, const Camera& camera) {
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  std::vector<VolumeBox> boxes;
  for (const SplatItem& item : list.splats)
    if (!bounds_of<qnv::Volume>(item).empty())
      boxes.push_back({item.geometry->description().box, glm::mat4(camera_from_world * item.world_from_node)});
  return boxes;
}

std::optional<SharedDepths> shared_depths(std::span<const GaussianItem> items, std::span<const VolumeBox> volumes,
                                          const SplatView& view) {
  std::size_t total = 0;
  for (const GaussianItem& item : items) total += item.count;
  const std::size_t step =
      std::max((total + kMostSampled - 1) / kMostSampled, (total * volumes.size() + kMostTested - 1) / kMostTested);
  SharedRegion region;
  for (const VolumeBox& volume : volumes) {
    const glm::mat4 volume_from_camera = glm::inverse(volume.camera_from_node);
    std::size_t next = 0;  // first splat of the sample in the item
    for (const GaussianItem& item : items) {
      const std::size_t count =
          std::min(item.count, item.gaussians->size() - std::min(item.first, item.gaussians->size()));
      if (next >= count) {
        next -= count;
        continue;
      }
      const glm::mat4 volume_from_node = volume_from_camera * item.camera_from_node;
      for (; next < count; next += step) {
        const glm::vec4 position(item.gaussians->positions[item.first + next], 1);
        const glm::vec3 inside(volume_from_node * position);
        if (glm::all(glm::greaterThanEqual(inside, volume.box.lower)) &&
            glm::all(glm::lessThanEqual(inside, volume.box.upper)))
          region.add(glm::vec3(item.camera_from_node * position), view);
      }
      next -= count;
    }
  }
  if (!(region.depths.nearest <= region.depths.farthest)) return std::nullopt;
  const glm::vec2 size = region.upper - region.lower;
  const float slabs = std::ceil(std::max(size.x, size.y) / kSlabPixels);
  return SharedDepths{region.depths, static_cast<std::size_t>(std::clamp(slabs, 1.0f, static_cast<float>(kSlabs)))};
}

}  // namespace gs::render
