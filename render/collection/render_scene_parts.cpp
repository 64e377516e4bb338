#include "render/collection/render_scene.h"

#include "render/scene/surface_mesh.h"
#include "vrml/scene/values/transformation.h"

#include <algorithm>
#include <utility>

// Part of RenderScene that updates single parts of the list.
namespace gs::render {

using glm::dmat4;
using glm::dvec3;

// ---- Content that depends on the viewer

// Updates LODs, Billboards and content in units of the picture for a new viewer. Returns false if an LOD selects
// another level.
bool RenderScene::follow_viewer(const dvec3& viewer) {
  for (const RenderSources::Lod& lod : sources_.lods) {
    const NodeView view{lod.node, &resources_.schemas().of(*lod.node->type)};
    if (lod_level(view, vrml::viewer_in_local(viewer, list_->world_from_frame[lod.frame])) != lod.level) return false;
  }
  const Screens screens(viewer, sight_, bound_.boundary);
  if (!sources_.layouts.empty() || !sources_.clips.empty()) follow_picture(screens);
  for (const std::uint32_t frame : sources_.billboards) {
    const RenderSources::Frame& source = sources_.frames[frame];
    const NodeView view{source.node, &resources_.schemas().of(*source.node->type)};
    const dmat4& parent = list_->world_from_frame[source.parent];
    const Screen& screen = screens.of(source.overlay);
    const dmat4 matrix = view.kind() == NodeKind::screen_group ? screen.in_pixels(parent, 1)
                         : view.kind() == NodeKind::shape
                             ? screen.in_pixels(parent, screen.pixels_per_point())
                             : billboard_matrix(view, vrml::viewer_in_local(viewer, parent),
                                                vrml::direction_in_local(sight_.orientation[1], parent));
    if (matrix != source.parent_from_local) mark_frame(frame, matrix);
  }
  return true;
}

// Places Layouts and the planes of their Viewports again. Outer Layouts move before inner ones are placed.
void RenderScene::follow_picture(const Screens& screens) {
  for (RenderSources::Layout& layout : sources_.layouts) {
    const RenderSources::Frame& source = sources_.frames[layout.frame];
    const NodeView view{layout.node, &resources_.schemas().of(*layout.node->type)};
    const Screen::Placement place = screens.place(layout, layout_values(view), sources_.layouts, source.overlay,
                                                  list_->world_from_frame[source.parent]);
    layout.size = place.size;
    if (place.parent_from_local == source.parent_from_local) continue;
    mark_frame(layout.frame, place.parent_from_local);
    move_frames();
    picture_moved_ = true;
  }
  for (const RenderSources::Clip& clip : sources_.clips) {
    const auto planes = screens.of(clip.overlay).planes(clip.part);
    const auto kept = list_->clip_planes.begin() + clip.first_plane;
    if (std::equal(planes.begin(), planes.end(), kept)) continue;
    std::copy(planes.begin(), planes.end(), kept);
    picture_moved_ = true;
  }
}

// Re-tessellates texts for their size in the image. Returns true if any text changed.
bool RenderScene::refine_texts() {
  bool any = false;
  for (const std::uint32_t i : sources_.texts) {
    DrawItem& item = list_->items[i];
    RenderSources::Item& source = sources_.items[i];
    const std::size_t level =
        text_level(*item.mesh, item.world_from_node, source.bounds, viewer_, sight_, !source.appearance.textured());
    if (level == source.text_level || item.place == kNoPlace) continue;
    const Place& place = list_->places[item.place];
    const NodeView shape = resources_.schemas().view(*place.scene, place.node);
    const vrml::NodeId geometry = geometry_of(*place.scene, shape);
    item.mesh = nullptr;  // release the mesh, so that the cache may free an unused level
    auto [mesh, made] = resources_.text_mesh_of(*place.scene, geometry, source.appearance.need_coordinates(), level);
    any = any || made != source.text_level;
    item.mesh = std::move(mesh);
    source.text_level = made;
    place_item(i);
  }
  return any;
}

// ---- Single parts

// Fits the boxes of bboxDisplay to their content (X3D 10.2.2). Returns true if one has changed.
bool RenderScene::follow_boxes() {
  constexpr std::size_t kMaxItems = 1'000'000;  // in all boxes; nested boxes contain an item repeatedly
  if (!std::exchange(boxes_stale_, false)) return false;
  bool any = false;
  std::size_t items = 0;
  for (const RenderSources::BoxItem& one : sources_.boxes) {
    items += one.item - one.first;
    if (items > kMaxItems) break;
    DrawItem& item = list_->items[one.item];
    const Box box = box_of_items(*list_, one.first, one.item, item.world_from_node);
    if (box.empty() || (box.lower == item.mesh->bounds.lower && box.upper == item.mesh->bounds.upper)) continue;
    item.mesh = edges_of(box);
    place_item(one.item);
    any = true;
  }
  boxes_stale_ = false;
  return any;
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
  if (!mesh || mesh->empty() || mesh->in_points != item.mesh->in_points) return false;
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
                         list_->world_from_frame[place.frame], viewer_, sight_.orientation[1]))
      continue;
    place_item(particles.item);
    if (item.layered) apply_item_appearance(particles.item);
    any = true;
  }
  return any;
}

void RenderScene::apply_item_appearance(std::uint32_t index) {
  const bool splat = (index & NodeUse::kSplat) != 0;
  const std::uint32_t place_index = splat ? list_->splats[index & ~NodeUse::kSplat].place : list_->items[index].place;
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
  SplatItem& item = list_->splats[index & ~NodeUse::kSplat];
  item.own_color = !dressed.material.lit;
  item.material = item.own_color ? Material{} : dressed.material;
}

// Makes the look of a volume again. Returns false if the volume vanishes.
bool RenderScene::renew_volume_item(std::uint32_t index) {
  DrawItem& item = list_->items[index];
  if (item.place == kNoPlace) return false;
  const Place& place = list_->places[item.place];
  const auto found =
      std::lower_bound(sources_.volumes.begin(), sources_.volumes.end(), index,
                       [](const RenderSources::Volume& volume, std::uint32_t wanted) { return volume.item < wanted; });
  if (found == sources_.volumes.end() || found->item != index) return false;
  if (!renew_volume(resources_, item, sources_.items[index], *found, *place.scene, place.node)) return false;
  place_item(index);
  return true;
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
    if (const RenderSources::Local& local = sources_.clip_planes[i]; local.node && is_changed(local))
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
  list_->has_background = false;
  list_->navigation = {};
  list_->fog = {};
  bool background = false, navigation = false, fog = false;
  for (const RenderSources::Local& local : sources_.bindables) {
    const NodeView view{local.node, &resources_.schemas().of(*local.node->type)};
    if (local.node == bound_.background && !std::exchange(background, true)) {
      set_background(local, view);
      list_->has_background = true;
    }
    if (local.node == bound_.fog && !std::exchange(fog, true))
      list_->fog = world_fog(view, list_->world_from_frame[local.frame]);
    if (local.node == bound_.navigation_info && !std::exchange(navigation, true))
      list_->navigation = navigation_state(view);
  }
}

}  // namespace gs::render
