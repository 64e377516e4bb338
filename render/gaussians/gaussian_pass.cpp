#include "render/gaussians/gaussian_pass.h"

#include "render/gaussians/gaussian_raster.h"
#include "render/splat/splat_budget.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <string_view>
#include <vector>

namespace gs::render {
namespace {

const qnv::Gaussians* gaussians_of(const SplatItem& item) {
  const auto* gaussians = item.geometry ? item.geometry->as<qnv::Gaussians>() : nullptr;
  return gaussians && !gaussians->empty() ? gaussians : nullptr;
}

std::vector<GaussianItem> items_of(const RenderList& list, const Camera& camera, const DrawOptions& options) {
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  std::vector<GaussianItem> items;
  for (const SplatItem& item : list.splats) {
    const qnv::Gaussians* gaussians = gaussians_of(item);
    if (!gaussians) continue;
    GaussianItem& own = items.emplace_back();
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
  return items;
}

}  // namespace

GaussianPass::GaussianPass(const Gl& gl) : target_(gl), overlay_(gl) {}

void GaussianPass::draw(const RenderList& list, const Camera& camera, const Projection& projection,
                        const DrawOptions& options, FrameStatistics& statistics) {
  if (std::none_of(list.splats.begin(), list.splats.end(), gaussians_of)) return;
  const SplatView view = viewport_view(camera, projection, options);
  const std::vector<GaussianItem> items = items_of(list, camera, options);
  VolumeStops stops;
  if (target_.read_depths({options.x, options.y, options.width, options.height}, projection, depths_))
    stops = depths_.stops();
  const VolumeLayer layer = rasterize_gaussians(items, view, stops);
  if (std::string_view(statistics.splats) == "none") statistics.splats = "cpu";
  statistics.vectors += layer.vectors;
  if (layer.empty()) return;
  overlay_.draw(layer, stops, projection, options);
  ++statistics.draw_calls;
}

}  // namespace gs::render
