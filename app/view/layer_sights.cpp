#include "app/view/layer_sights.h"

#include "app/view/navigation.h"

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

/// Returns the part of a viewport that a layer with this clipBoundary fills.
Viewport part_of_viewport(const Viewport& whole, const vrml::ClipBoundary& boundary) {
  const auto at = [](double fraction, int pixels) { return static_cast<int>(std::lround(fraction * pixels)); };
  const int left = at(boundary[0], whole.width), right = at(boundary[1], whole.width);
  const int bottom = at(boundary[2], whole.height), top = at(boundary[3], whole.height);
  return {whole.left + left, whole.top + whole.height - top, std::max(right - left, 1), std::max(top - bottom, 1)};
}

}  // namespace

std::vector<LayerSight> layer_sights(const render::RenderList& list, const Pose& pose, const Viewport& place) {
  std::vector<LayerSight> sights;
  const auto add = [&](std::size_t index, const render::RenderList& content, const Pose& viewer) {
    if (content.pickable) sights.push_back({index, &content, viewer, part_of_viewport(place, content.boundary)});
  };
  bool active = false;
  for (std::size_t i = list.layers.size(); i-- > 0;) {
    const render::RenderLayer& layer = list.layers[i];
    if (!layer.in_front && !active) {
      add(LayerSight::kActive, list, pose);
      active = true;
    }
    Pose viewer = pose_of(layer.camera.world_from_camera, layer.camera.field_of_view);
    if (layer.extent.x > 0) {
      const glm::dvec2 size(part_of_viewport(place, layer.list->boundary).size());
      viewer.height = height_that_shows(layer.extent, size);
    }
    add(i, *layer.list, viewer);
  }
  if (!active) add(LayerSight::kActive, list, pose);
  return sights;
}

}  // namespace gs::app
