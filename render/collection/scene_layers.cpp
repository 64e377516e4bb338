#include "render/collection/scene_layers.h"

#include "render/collection/render_scene.h"

#include <utility>

namespace gs::render {
namespace {

/// Returns the bound nodes of a layer that is drawn besides the active one.
BoundNodes nodes_of(const BoundNodes& bound, const BoundLayer& layer) {
  BoundNodes nodes{layer.viewpoint, layer.navigation_info, layer.background, layer.fog};
  nodes.layer_set = bound.layer_set;
  nodes.layer = layer.layer;
  nodes.boundary = layer.boundary;
  nodes.pickable = layer.pickable;
  return nodes;
}

/// Returns a layer with the lens of its bound Viewpoint.
RenderLayer with_lens(const BoundLayer& bound, std::shared_ptr<const RenderList> list) {
  RenderLayer layer{std::move(list), bound.in_front, {}, {}};
  layer.camera.world_from_camera[3] = {0, 0, 10, 1};
  if (bound.parallel && !bound.viewpoint) layer.extent = kLayoutExtent;
  for (const ViewpointState& viewpoint : layer.list->viewpoints) {
    if (!bound.viewpoint || &viewpoint.scene->node(viewpoint.node) != bound.viewpoint) continue;
    layer.camera.world_from_camera = viewpoint.world_from_camera;
    layer.camera.field_of_view = viewpoint.field_of_view;
    layer.extent = viewpoint.extent;
    break;
  }
  return layer;
}

}  // namespace

SceneLayers::SceneLayers(const vrml::SceneGraph& scene, const Images& images, const Geometries& geometries,
                         MeshCache& meshes)
    : scene_(scene), images_(images), geometries_(geometries), meshes_(meshes) {}
SceneLayers::SceneLayers(SceneLayers&& other) noexcept = default;
SceneLayers::~SceneLayers() = default;

void SceneLayers::gather(const BoundNodes& bound, const Sight& sight, std::vector<RenderLayer>& listed) {
  layers_.clear();
  listed.clear();
  for (std::size_t i = 0; i < bound.others.size(); ++i) {
    layers_.push_back(std::make_unique<RenderScene>(scene_, images_, geometries_, meshes_));
    layers_.back()->gather(nodes_of(bound, bound.others[i]), {0, 0, 10});
    listed.push_back(with_lens(bound.others[i], layers_.back()->shared_list()));
    (void)show(i, {}, bound, sight, listed.back());
  }
}

bool SceneLayers::update(std::span<const vrml::NodeChange> changes, const BoundNodes& bound, const Sight& sight,
                         std::vector<RenderLayer>& listed) {
  bool any = false;
  for (std::size_t i = 0; i < layers_.size(); ++i) any = show(i, changes, bound, sight, listed[i]) || any;
  return any;
}

// Updates a layer for its lens. If its Viewpoint has moved, updates it again.
bool SceneLayers::show(std::size_t index, std::span<const vrml::NodeChange> changes, const BoundNodes& bound,
                       const Sight& sight, RenderLayer& layer) {
  const BoundLayer& one = bound.others[index];
  const auto update = [&](std::span<const vrml::NodeChange> of_layer) {
    Sight seen = sight;
    seen.orientation = glm::dmat3(layer.camera.world_from_camera);
    seen.field_of_view = layer.camera.field_of_view;
    const vrml::ClipBoundary& part = one.boundary;
    seen.height =
        layer.extent.x > 0
            ? height_for(layer.extent, {seen.pixels.x * (part[1] - part[0]), seen.pixels.y * (part[3] - part[2])})
            : 0;
    layers_[index]->set_sight(seen);
    return layers_[index]->update(of_layer, nodes_of(bound, one), layer.camera.world_from_camera[3]);
  };
  if (!update(changes)) return false;
  RenderLayer lens = with_lens(one, layers_[index]->shared_list());
  const bool moved = lens.camera != layer.camera || lens.extent != layer.extent;
  layer = std::move(lens);
  if (moved) (void)update({});
  return true;
}

}  // namespace gs::render
