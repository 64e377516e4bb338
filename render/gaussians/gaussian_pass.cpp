#include "render/gaussians/gaussian_pass.h"

#include "qnv/codecs/shared/chunk_requests.h"
#include "render/collection/collector.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/splat/splat_budget.h"
#include "render/splat/splat_pieces.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace gs::render {
namespace {

const qnv::Gaussians* gaussians_of(const SplatItem& item) {
  const auto* gaussians = item.geometry ? item.geometry->as<qnv::Gaussians>() : nullptr;
  return gaussians && !gaussians->empty() ? gaussians : nullptr;
}

/// Gaussians of one image. held[i] owns the data of items[i].
struct GaussianScene {
  std::vector<std::shared_ptr<const qnv::Gaussians>> held;
  std::vector<GaussianItem> items;
};

GaussianScene scene_of(const RenderList& list, const Camera& camera, const DrawOptions& options) {
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  GaussianScene scene;
  for (const SplatItem& item : list.splats) {
    const qnv::Gaussians* gaussians = gaussians_of(item);
    if (!gaussians) continue;
    scene.held.push_back(qnv::shared_as<qnv::Gaussians>(item.geometry));
    GaussianItem& own = scene.items.emplace_back();
    own.gaussians = gaussians;
    own.count = gaussians->size();
    own.camera_from_node = glm::mat4(camera_from_world * item.world_from_node);
    own.opacity = options.splat_style.opacity * (1 - item.material.transparency);
    // As volumes, Gaussians are clipped by one plane: the viewer's, or the outermost ClipPlane.
    if (options.splat_style.clip)
      own.clip = glm::vec4(*options.splat_style.clip * item.world_from_node);
    else if (!item.clip_planes.empty() && item.clip_planes[0] < list.clip_planes.size())
      own.clip = glm::vec4(list.clip_planes[item.clip_planes[0]] * item.world_from_node);
    own.fog = camera_fog(list.fog, glm::transpose(glm::mat3(camera_from_world)), static_cast<float>(camera.back));
  }
  return scene;
}

/// Notes the view with the streams of Gaussians, which send the parts in view first. `view` is that of the whole picture.
void note_view(const RenderList& list, const Camera& camera, const DrawOptions& options, SplatView view) {
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  std::unordered_map<const qnv::ChunkRequests*, std::uint32_t> shown;  // instances of each stream so far
  for (const SplatItem& item : list.splats) {
    if (!gaussians_of(item) || !item.geometry->base().requests) continue;
    const auto& requests = item.geometry->base().requests;
    view.camera_from_node = glm::mat4(camera_from_world * item.world_from_node);
    auto looked = lod_view(view);
    if (!looked) continue;
    looked->budget = options.budget;
    looked->error_pixels = item.detail > 0 ? 1 / item.detail : 1.0f;
    looked->viewport = options.viewport + (shown[requests.get()]++ << 16);
    requests->note(*looked);
  }
}

/// Returns the bounds of all volumes, or of all Gaussians, in world space.
template <class Content>
WideBox bounds_of_all(const RenderList& list) {
  WideBox bounds;
  for (const SplatItem& item : list.splats) {
    if (!item.geometry || !item.geometry->as<Content>() || item.geometry->description().box.empty()) continue;
    const WideBox own = world_bounds(item.geometry->description().box, item.world_from_node);
    if (!own.empty()) bounds.add(own);
  }
  return bounds;
}

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

GaussianPass::GaussianPass(const Gl& gl, SortMethod sort)
    : gl_(gl), target_(gl), gaussian_gl_(gl, target_, sort), overlay_(gl) {}

void GaussianPass::draw(const RenderList& list, const Camera& camera, const Projection& projection,
                        const DrawOptions& options, FrameStatistics& statistics) {
  gaussian_gl_.forget_unused();
  if (std::none_of(list.splats.begin(), list.splats.end(), gaussians_of)) return;
  const SplatView view = viewport_view(camera, projection, options);
  note_view(list, camera, options, whole_view(view, camera));
  const GaussianScene scene = scene_of(list, camera, options);
  const TargetRectangle rectangle{options.x, options.y, options.width, options.height};
  const bool with_gl = options.splats == SplatPath::gl || (options.splats == SplatPath::automatic && !gl_.software);
  if (with_gl) {
    if (const auto drawn =
            gaussian_gl_.draw(scene.held, scene.items, {view, projection, rectangle, options.viewport})) {
      statistics.vectors += drawn->vectors;
      statistics.pending = statistics.pending || drawn->pending;
      if (std::string_view(statistics.splats) == "none") statistics.splats = "gl";
      ++statistics.draw_calls;
      return;
    }
    statistics.splats = "cpu";  // shows that OpenGL could not draw splats
  }
  VolumeStops stops;
  if (target_.read_depths(rectangle, projection, depths_)) stops = depths_.stops();
  const VolumeLayer layer = rasterize_gaussians(scene.items, view, stops);
  if (std::string_view(statistics.splats) == "none") statistics.splats = "cpu";
  statistics.vectors += layer.vectors;
  if (layer.empty()) return;
  overlay_.draw(layer, stops, projection, options);
  ++statistics.draw_calls;
}

}  // namespace gs::render
