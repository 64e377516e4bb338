#include "render/collection/render_scene.h"

#include "vrml/scene/values/transformation.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace gs::render {
namespace {

using glm::dmat4;
using glm::dvec3;

dvec3 usable(const dvec3& viewer) {
  return std::isfinite(viewer.x) && std::isfinite(viewer.y) && std::isfinite(viewer.z) ? viewer : dvec3(0, 0, 10);
}

/// Reports whether a change concerns a field of an X3D node that holds nodes.
bool has_changed_nodes(const vrml::NodeChange& change, const vrml::Node& node) {
  if (node.type->language != vrml::Language::x3d) return false;
  for (std::size_t i = 0; i < node.type->defaults.size(); ++i)
    if ((change.slots >> std::min<std::size_t>(i, 63) & 1) != 0 && vrml::holds_nodes(vrml::type_of(node.values[i])))
      return true;
  return false;
}

/// Assigns a new generation to a list.
void begin_generation(RenderList& list) {
  static std::atomic<std::uint64_t> last{0};
  list.generation = ++last;
  list.moved.clear();
}

/// Reports whether a node is a texture of the bound TextureBackground.
bool is_face(const RenderSources& sources, const vrml::Node* background, const vrml::Node* node) {
  if (!background || background->type->language != vrml::Language::x3d) return false;
  return std::any_of(sources.bindables.begin(), sources.bindables.end(), [&](const RenderSources::Local& local) {
    if (local.node != background || !local.scene) return false;
    const auto faces = inner_nodes(*local.scene, *local.node);
    return std::find(faces.begin(), faces.end(), node) != faces.end();
  });
}

/// Reports whether a change concerns this field of the node.
bool has_changed(const vrml::NodeChange& change, const NodeView& view, int field) {
  const int slot = view.schema->slots[static_cast<std::size_t>(field)];
  return slot >= 0 && (change.slots >> std::min(slot, 63) & 1) != 0;
}

}  // namespace

RenderList::RenderList() = default;
RenderList::RenderList(const RenderList& other) = default;
RenderList::RenderList(RenderList&& other) noexcept = default;
RenderList& RenderList::operator=(const RenderList& other) = default;
RenderList& RenderList::operator=(RenderList&& other) noexcept = default;
RenderList::~RenderList() = default;

std::uint64_t next_change() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

RenderScene::RenderScene(const vrml::SceneGraph& scene, const Images& images, const Geometries& geometries,
                         MeshCache& meshes)
    : scene_(scene),
      images_(images),
      geometries_(geometries),
      resources_(images, meshes, scene.budget()),
      list_(std::make_shared<RenderList>()),
      layers_(scene, images, geometries, meshes) {}

void RenderScene::gather(const BoundNodes& bound, const dvec3& viewer) {
  bound_ = bound;
  viewer_ = usable(viewer);
  resources_.forget_refiners();
  *list_ = Collector(resources_, viewer_, geometries_, &bound_, scene_.budget(), &sources_, sight_).collect(scene_);
  list_->boundary = bound_.boundary;
  list_->pickable = bound_.pickable && bound_.drawn;
  list_->drawn = bound_.drawn;
  if (bound_.parallel && !bound_.viewpoint) list_->default_extent = kLayoutExtent;
  layers_.gather(bound_, sight_, list_->layers);
  ++gathered_;
  begin_generation(*list_);
  list_->changes = next_change();
  uses_.forget();
  moved_frames_.clear();
  frame_moved_.assign(sources_.frames.size(), false);
  bounds_.reset(list_->items.size());
  for (std::size_t i = 0; i < sources_.items.size(); ++i)
    if (const WideBox* bounds = bounds_of(i)) bounds_.add(i, *bounds);
  frame_lost_ = splat_moved_ = boxes_stale_ = false;
}

bool RenderScene::update(std::span<const vrml::NodeChange> changes, const BoundNodes& bound, const dvec3& viewer) {
  bool any = false, whole = gathered_ == 0;
  for (std::size_t i = 0; i < changes.size() && !whole; ++i) {
    const vrml::NodeChange& change = changes[i];
    if (!change.scene->contains(change.node)) continue;  // the node was removed after this change, with its content
    const vrml::Node& node = change.scene->node(change.node);
    const Effect effect = effect_of(change, node);
    if (effect == Effect::none) continue;
    whole = effect == Effect::everything || !sources_.complete;
    if (whole) break;
    switch (effect) {
      case Effect::frame:
        for (const NodeUse& use : uses_.of_frame(&node, sources_)) {
          whole = whole || use.index == NodeUse::kUnshown;
          if (use.index != NodeUse::kUnshown && sources_.frames[use.index].node)
            mark_frame(use.index, transform_matrix({&node, &resources_.schemas().of(*node.type)}));
        }
        break;
      case Effect::apply_appearance:
      case Effect::geometry:
        if (is_face(sources_, bound_.background, &node)) renew_bindables(), any = true;
        for (const NodeUse& use : uses_.of_item(&node, *list_, sources_)) {
          whole = whole || use.index == NodeUse::kUnshown ||
                  (effect == Effect::geometry && (use.index & NodeUse::kSplat) != 0) ||
                  (effect == Effect::geometry && !renew_geometry(use.index));
          if (whole) break;
          if (effect == Effect::apply_appearance && (use.index & NodeUse::kSplat) == 0 &&
              list_->items[use.index].volume) {
            whole = !renew_volume_item(use.index);
            if (whole) break;
          } else if (effect == Effect::apply_appearance) {
            apply_item_appearance(use.index);
          }
          any = true;
        }
        break;
      case Effect::light:
        for (std::uint32_t k = 0; k < sources_.lights.size(); ++k)
          if (sources_.lights[k].node == &node) renew_light(k), any = true;
        break;
      case Effect::scoped:
        renew_scoped([&](const RenderSources::Local& local) { return local.node == &node; });
        any = true;
        break;
      case Effect::viewpoint:
        for (std::uint32_t k = 0; k < sources_.viewpoints.size(); ++k)
          if (sources_.viewpoints[k].node == &node) renew_viewpoint(k), any = true;
        break;
      case Effect::bindable:
        if (&node == bound_.background || &node == bound_.navigation_info || &node == bound_.fog)
          renew_bindables(), any = true;
        break;
      case Effect::none:
      case Effect::everything:
        break;
    }
  }
  if (!whole) {
    any = any || !moved_frames_.empty();
    move_frames();
    const bool rebound = bound.background != bound_.background || bound.navigation_info != bound_.navigation_info ||
                         bound.fog != bound_.fog;
    const bool other_viewpoint = bound.viewpoint != bound_.viewpoint;
    whole = bound.layer != bound_.layer || bound.layer_set != bound_.layer_set || bound.boundary != bound_.boundary ||
            bound.pickable != bound_.pickable || bound.drawn != bound_.drawn || bound.others != bound_.others ||
            bound.parallel != bound_.parallel ||
            (bound.parallel && (bound.viewpoint != nullptr) != (bound_.viewpoint != nullptr));
    bound_ = bound;
    if (rebound) renew_bindables(), any = true;
    if (other_viewpoint || any) {
      const float nearest = list_->near_distance, farthest = list_->far_distance;
      take_distances(*list_, bound_.viewpoint);
      any = any || nearest != list_->near_distance || farthest != list_->far_distance;
    }
    viewer_ = usable(viewer);
    if (depends_on_viewer()) {
      picture_moved_ = false;
      whole = !follow_viewer(viewer_) || whole;
      any = any || picture_moved_ || !moved_frames_.empty();
      move_frames();
      if (!whole && refine_texts()) any = true;
      if (!whole && move_particles()) any = true;
    }
    if (!whole && follow_boxes()) any = true;
    if (!whole && layers_.update(changes, bound_, sight_, list_->layers)) any = true;
    // A coordinate system has overflowed and hides its content, so collect again.
    whole = whole || frame_lost_;
  }
  if (whole) {
    gather(bound, viewer);
    return true;
  }
  sum_bounds();
  if (any) list_->changes = next_change();
  return any;
}

RenderScene::Effect RenderScene::effect_of(const vrml::NodeChange& change, const vrml::Node& node) {
  const NodeView view{&node, &resources_.schemas().of(*node.type)};
  // The body of the PROTO instance has changed.
  if (node.type->prototype && (change.slots >> 63 & 1) != 0) return Effect::everything;
  const auto changed = [&](int slot) { return slot >= 0 && (change.slots >> std::min(slot, 63) & 1) != 0; };
  if (changed(view.schema->visible) || changed(view.schema->box_display)) return Effect::everything;
  const auto only = [&](Effect effect, int children) {
    return has_changed(change, view, children) ? Effect::everything : effect;
  };
  switch (view.kind()) {
    case NodeKind::transform:
      return only(Effect::frame, TransformFields::children);
    case NodeKind::geo_group:
    case NodeKind::geo_lod:
      return Effect::everything;
    case NodeKind::humanoid:
      if (has_changed(change, view, HumanoidFields::skin)) return Effect::everything;
      return only(Effect::frame, HumanoidFields::skeleton);
    case NodeKind::screen_group:
      return only(Effect::none, GroupFields::children);
    case NodeKind::billboard:
      return only(Effect::none, BillboardFields::children);  // the next update of the viewer rotates it
    case NodeKind::group:
      return only(Effect::none, GroupFields::children);
    case NodeKind::particle_system:
      return has_changed_nodes(change, node) ? Effect::everything : Effect::none;
    case NodeKind::layout:
      return Effect::none;  // the next update of the viewer places it
    case NodeKind::layer_set:
    case NodeKind::layer:
    case NodeKind::layout_layer:
    case NodeKind::layout_group:
    case NodeKind::viewport:
    case NodeKind::collision:
    case NodeKind::switch_node:
    case NodeKind::lod:
    case NodeKind::inline_node:
    case NodeKind::shape:
    case NodeKind::appearance:
    case NodeKind::cad_face:
      return Effect::everything;
    case NodeKind::clip_plane:
      return only(Effect::scoped, ClipPlaneFields::enabled);
    case NodeKind::local_fog:
      return only(Effect::scoped, LocalFogFields::enabled);
    case NodeKind::volume_data:
    case NodeKind::segmented_volume:
    case NodeKind::iso_surface_volume:
    case NodeKind::opacity_map_style:
    case NodeKind::boundary_style:
    case NodeKind::edge_style:
    case NodeKind::tone_mapped_style:
    case NodeKind::silhouette_style:
    case NodeKind::cartoon_style:
    case NodeKind::shaded_style:
    case NodeKind::composed_style:
    case NodeKind::blended_style:
    case NodeKind::projection_style:
    case NodeKind::line_properties:
    case NodeKind::fill_properties:
    case NodeKind::point_properties:
    case NodeKind::material:
    case NodeKind::texture_transform:
    case NodeKind::pixel_texture:
    case NodeKind::image_texture:
    case NodeKind::movie_texture:
    case NodeKind::physical_material:
    case NodeKind::unlit_material:
    case NodeKind::two_sided_material:
    case NodeKind::multi_texture:
    case NodeKind::multi_texture_transform:
    case NodeKind::texture_transform_3d:
    case NodeKind::texture_transform_matrix_3d:
    case NodeKind::texture_coordinate_generator:
    case NodeKind::texture_properties:
    case NodeKind::composed_cube_map_texture:
    case NodeKind::image_cube_map_texture:
    case NodeKind::generated_cube_map_texture:
    case NodeKind::composed_texture_3d:
    case NodeKind::image_texture_3d:
    case NodeKind::pixel_texture_3d:
      return has_changed_nodes(change, node) ? Effect::everything : Effect::apply_appearance;
    case NodeKind::directional_light:
    case NodeKind::point_light:
    case NodeKind::spot_light:
      return has_changed(change, view, LightFields::global) ? Effect::everything : only(Effect::light, LightFields::on);
    case NodeKind::viewpoint_group:
      return Effect::everything;
    case NodeKind::viewpoint:
      return has_changed(change, view, ViewpointFields::navigation_info) ? Effect::everything : Effect::viewpoint;
    case NodeKind::navigation_info:
    case NodeKind::background:
    case NodeKind::fog:
      return Effect::bindable;
    case NodeKind::qnv:
      return Effect::everything;
    default:
      break;
  }
  return vrml::has(node.type->role, kGeometryParts) ? Effect::geometry : Effect::none;
}

// ---- Coordinate systems

void RenderScene::mark_frame(std::uint32_t frame, const dmat4& parent_from_local) {
  sources_.frames[frame].parent_from_local = parent_from_local;
  if (frame_moved_[frame]) return;
  frame_moved_[frame] = true;
  moved_frames_.push_back(frame);
}

// Moves outer frames first, because their matrices affect inner frames.
void RenderScene::move_frames() {
  std::sort(moved_frames_.begin(), moved_frames_.end());
  std::uint32_t done = 0;
  for (const std::uint32_t first : moved_frames_) {
    frame_moved_[first] = false;
    if (first < done) continue;
    const RenderSources::Frame& top = sources_.frames[first];
    done = std::max(top.end, first + 1);
    for (std::uint32_t i = first; i < done; ++i) {
      const RenderSources::Frame& frame = sources_.frames[i];
      dmat4& world = list_->world_from_frame[i];
      world = list_->world_from_frame[frame.parent] * frame.parent_from_local;
      if (!fits_float(world)) frame_lost_ = true;
    }
    for (std::uint32_t i = top.first_item; i < top.end_item; ++i) place_item(i);
    for (std::uint32_t i = top.first_splat; i < top.end_splat; ++i) place_splat(i);
    for (std::uint32_t i = top.first_light; i < top.end_light; ++i) renew_light(i);
    renew_scoped([&](const RenderSources::Local& local) { return local.frame >= first && local.frame < done; });
    for (std::uint32_t i = 0; i < sources_.viewpoints.size(); ++i)
      if (sources_.viewpoints[i].frame >= first && sources_.viewpoints[i].frame < done) renew_viewpoint(i);
    for (const RenderSources::Local& local : sources_.bindables)
      if ((local.node == bound_.background || local.node == bound_.fog) && local.frame >= first && local.frame < done)
        renew_bindables();
  }
  moved_frames_.clear();
}

void RenderScene::place_item(std::uint32_t i) {
  DrawItem& item = list_->items[i];
  if (item.place == kNoPlace) return;
  RenderSources::Item& source = sources_.items[i];
  const dmat4& world = list_->world_from_frame[list_->places[item.place].frame];
  const dmat4 world_from_node = item.surface                   ? world_from_geometry(world, *item.surface)
                                : source.scale == glm::vec3(1) ? world_from_mesh(world, *item.mesh)
                                                               : glm::scale(world, dvec3(source.scale));
  if (!fits_float(world_from_node)) {
    frame_lost_ = true;
    return;
  }
  item.world_from_node = world_from_node;
  source.bounds = world_bounds(source.region.empty() ? item.mesh->bounds : source.region, world_from_node);
  item_moved(i);
}

void RenderScene::place_splat(std::uint32_t i) {
  SplatItem& splat = list_->splats[i];
  if (splat.place == kNoPlace) return;
  const dmat4 world = world_from_geometry(list_->world_from_frame[list_->places[splat.place].frame], *splat.geometry);
  splat.world_from_node = world;
  const Box& box = splat.geometry->description().box;
  sources_.splats[i].bounds = world_bounds({box.lower, box.upper}, world);
  splat_moved_ = true;
}

// ---- Bounds of all items

void RenderScene::item_moved(std::uint32_t item) {
  // If items move all the time, begin a new generation now and then, before `moved` becomes too long.
  constexpr std::size_t kLongest = 64;  // maximum length of `moved`, per item
  if (list_->moved.size() >= kLongest * list_->items.size()) begin_generation(*list_);
  list_->moved.push_back(item);
  boxes_stale_ = true;
  bounds_.note_change(item);
}

// Returns the bounds of an item if they count for the bounds of the list; otherwise null.
const WideBox* RenderScene::bounds_of(std::size_t item) const {
  const DrawItem& drawn = list_->items[item];
  const WideBox& bounds = sources_.items[item].bounds;
  return drawn.visible && !drawn.overlay && !bounds.empty() ? &bounds : nullptr;
}

void RenderScene::sum_bounds() {
  if (!bounds_.has_changes() && !splat_moved_) return;
  bounds_.renew([&](std::size_t item) { return bounds_of(item); });
  splat_moved_ = false;
  list_->bounds = bounds_.sum();
  for (const RenderSources::Item& splat : sources_.splats)
    if (!splat.bounds.empty()) list_->bounds.add(splat.bounds);
}

void forget_changed(MeshCache& meshes, std::span<const vrml::NodeChange> changes) {
  for (const vrml::NodeChange& change : changes) {
    if (!change.scene->contains(change.node)) continue;
    const vrml::Node& node = change.scene->node(change.node);
    if (vrml::has(node.type->role, kGeometryParts)) meshes.forget(&node);
  }
}

}  // namespace gs::render
