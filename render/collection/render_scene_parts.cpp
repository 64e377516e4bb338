#include "render/collection/render_scene.h"

#include "render/scene/surface_mesh.h"

#include <algorithm>
#include <utility>

// Part of RenderScene that updates single parts of the list.
namespace gs::render {

std::vector<const vrml::Node*> inner_nodes(const vrml::SceneGraph& scene, const vrml::Node& node) {
  constexpr std::size_t kMaxNodes = 64;
  std::vector<const vrml::Node*> nodes;
  const auto add = [&](vrml::NodeId id) {
    id = scene.resolve(id);
    if (id && nodes.size() < kMaxNodes) nodes.push_back(&scene.node(id));
  };
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
    if (const auto* one = std::get_if<vrml::SFNode>(&node.values[i])) add(*one);
    if (const auto* several = std::get_if<vrml::MFNode>(&node.values[i]))
      for (const vrml::NodeId id : *several) add(id);
  }
  return nodes;
}

/// Reports whether a node is a texture of the bound TextureBackground.
bool RenderScene::is_face(const vrml::Node* node) const {
  if (!bound_.background || bound_.background->type->language != vrml::Language::x3d) return false;
  return std::any_of(sources_.bindables.begin(), sources_.bindables.end(), [&](const RenderSources::Local& local) {
    if (local.node != bound_.background || !local.scene) return false;
    const auto faces = inner_nodes(*local.scene, *local.node);
    return std::find(faces.begin(), faces.end(), node) != faces.end();
  });
}

// Updates the geometry of an item. Returns false if everything must be collected again because content appears or
// vanishes.
bool RenderScene::renew_geometry(std::uint32_t i) {
  DrawItem& item = list_->items[i];
  if (item.place == kNoPlace || item.surface || !item.touchable) return false;
  const Place& place = list_->places[item.place];
  const NodeView shape = resources_.schemas().view(*place.scene, place.node);
  const vrml::NodeId geometry = geometry_of(*place.scene, shape);
  if (!geometry || vrml::scale_of_primitive(*place.scene, geometry)) return false;
  auto mesh = resources_.mesh_of(*place.scene, geometry, sources_.items[i].appearance.need_coordinates());
  if (!mesh || mesh->empty()) return false;
  item.mesh = std::move(mesh);
  if (item.layered) apply_item_appearance(i);
  sources_.items[i].text_level = ShapeResources::kCoarsestText;
  place_item(i);
  return true;
}

// Shows the present particles, and turns sprites to the viewer. Returns true if any item changed.
bool RenderScene::move_particles() {
  bool any = false;
  for (RenderSources::Particles& particles : sources_.particles) {
    DrawItem& item = list_->items[particles.item];
    if (item.place == kNoPlace) continue;
    const Place& place = list_->places[item.place];
    if (!renew_particles(item, sources_.items[particles.item], particles, *place.scene, place.node,
                         list_->world_from_frame[place.frame], viewer_, viewer_up_))
      continue;
    place_item(particles.item);
    if (item.layered) apply_item_appearance(particles.item);
    any = true;
  }
  return any;
}

void RenderScene::apply_item_appearance(std::uint32_t index) {
  const bool splat = (index & kSplat) != 0;
  const std::uint32_t place_index = splat ? list_->splats[index & ~kSplat].place : list_->items[index].place;
  if (place_index == kNoPlace) return;
  const Place& place = list_->places[place_index];
  const NodeView shape = resources_.schemas().view(*place.scene, place.node);
  if (!splat) {
    DrawItem& item = list_->items[index];
    resources_.apply_appearance(item, *place.scene, shape, sources_.items[index].scale);
    dress_surface(item);
    const auto* mesh = item.surface ? item.surface->as<qnv::IndexedMesh>() : nullptr;
    if (mesh && !item.mesh->texture_coordinates.empty())
      item.texture = resources_.surface_texture(*sources_.items[index].geometry, *mesh);
    ++list_->dressed;
    return;
  }
  DrawItem dressed;
  resources_.apply_appearance(dressed, *place.scene, shape);
  SplatItem& item = list_->splats[index & ~kSplat];
  item.own_color = !dressed.material.lit;
  item.material = item.own_color ? Material{} : dressed.material;
}

void RenderScene::renew_light(std::uint32_t i) {
  const RenderSources::Local& local = sources_.lights[i];
  list_->lights[i] =
      world_light({local.node, &resources_.schemas().of(*local.node->type)}, list_->world_from_frame[local.frame]);
}

// Updates the ClipPlanes and LocalFogs for which `is_changed(local)` returns true.
void RenderScene::renew_scoped(const std::function<bool(const RenderSources::Local&)>& is_changed) {
  const auto view_of = [&](const RenderSources::Local& local) {
    return NodeView{local.node, &resources_.schemas().of(*local.node->type)};
  };
  for (std::size_t i = 0; i < sources_.clip_planes.size(); ++i)
    if (const RenderSources::Local& local = sources_.clip_planes[i]; is_changed(local))
      list_->clip_planes[i] = world_clip_plane(view_of(local), list_->world_from_frame[local.frame]);
  for (std::size_t i = 0; i < sources_.local_fogs.size(); ++i)
    if (const RenderSources::Local& local = sources_.local_fogs[i]; is_changed(local))
      list_->local_fogs[i] = world_fog(view_of(local), list_->world_from_frame[local.frame]);
}

void RenderScene::renew_viewpoint(std::uint32_t i) {
  const RenderSources::Local& local = sources_.viewpoints[i];
  ViewpointState& viewpoint = list_->viewpoints[i];
  ViewpointState made = world_viewpoint(*viewpoint.scene, {local.node, &resources_.schemas().of(*local.node->type)},
                                        list_->world_from_frame[local.frame]);
  made.scene = viewpoint.scene;
  made.node = viewpoint.node;
  take_group(made, viewpoint);
  viewpoint = std::move(made);
}

void RenderScene::set_background(const RenderSources::Local& local, const NodeView& view) {
  list_->background = world_background(view, list_->world_from_frame[local.frame], images_);
  if (local.scene) resources_.add_faces(list_->background, *local.scene, view);
}

void RenderScene::renew_bindables() {
  list_->background = {};
  list_->navigation = {};
  list_->fog = {};
  bool background = false, navigation = false, fog = false;
  for (const RenderSources::Local& local : sources_.bindables) {
    const NodeView view{local.node, &resources_.schemas().of(*local.node->type)};
    if (local.node == bound_.background && !std::exchange(background, true)) set_background(local, view);
    if (local.node == bound_.fog && !std::exchange(fog, true))
      list_->fog = world_fog(view, list_->world_from_frame[local.frame]);
    if (local.node == bound_.navigation_info && !std::exchange(navigation, true))
      list_->navigation = navigation_state(view);
  }
}

}  // namespace gs::render
