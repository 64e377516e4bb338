#include "render/collection/collector.h"

#include "render/scene/surface_mesh.h"
#include "vrml/event_model/behaviour.h"
#include "vrml/scene/imported_use.h"
#include "vrml/scene/values/transformation.h"
#include "vrml/syntax/stand_ins.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace gs::render {
namespace {

using glm::dmat4;
using glm::dvec3;

constexpr std::size_t kMaxLights = 60'000;  // DrawItem stores indexes of lights in 16 bits
constexpr std::size_t kMaxScoped = 60'000;  // ClipPlanes, and LocalFogs: DrawItem stores indexes in 16 bits
constexpr std::size_t kMaxSounds = 10'000;
constexpr std::size_t kMaxDepth = 100'000;
constexpr std::size_t kBetweenLooks = 1024;  // visits between two checks for cancellation

/// Reports whether a PROTO of the node is a stand-in with content that is fixed to the viewer.
bool begins_overlay(const vrml::SceneGraph& scene, vrml::NodeId id) {
  constexpr int kMaxSteps = 64;
  for (int step = 0; step < kMaxSteps; ++step) {
    const vrml::Node& node = scene.node(id);
    if (node.type->stands_in && vrml::is_overlay(*node.type)) return true;
    if (node.expansion.empty()) return false;
    id = node.expansion.front();
    if (!scene.contains(id)) return false;
  }
  return false;
}

/// Reports whether a node is a light that reaches only its group: a DirectionalLight (VRML97 6.16), or any light of X3D
/// with `global` FALSE.
bool is_listed_light(const NodeView& view) {
  switch (view.kind()) {
    case NodeKind::directional_light:
      return !view.get(LightFields::global, false);
    case NodeKind::point_light:
    case NodeKind::spot_light:
      return !view.get(LightFields::global, true);
    default:
      return false;
  }
}

/// Returns the number of parts that a list draws or is lit by.
std::size_t content_of(const RenderList& list) {
  return list.items.size() + list.splats.size() + list.lights.size() + list.clip_planes.size() + list.local_fogs.size();
}

/// Reports whether a root node of the world does not belong to the collected layer.
bool is_outside_of_layer(const BoundNodes* bound, const vrml::SceneGraph& scene, vrml::NodeId root) {
  return bound && bound->layer_set && (scene.resolve(root) == bound->layer_set) != (bound->layer > 0);
}

}  // namespace

bool fits_float(const dmat4& m) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += std::abs(m[i].x) + std::abs(m[i].y) + std::abs(m[i].z);
  return sum < std::numeric_limits<float>::max();  // also false for NaN
}

WideBox world_bounds(const Box& bounds, const dmat4& matrix) {
  WideBox result;
  if (bounds.empty()) return result;
  const dvec3 center = (dvec3(bounds.lower) + dvec3(bounds.upper)) * 0.5,
              half = (dvec3(bounds.upper) - dvec3(bounds.lower)) * 0.5;
  const dvec3 moved(matrix * glm::dvec4(center, 1));
  dvec3 extent(0);
  for (int i = 0; i < 3; ++i) extent += glm::abs(dvec3(matrix[i])) * half[i];
  result.lower = moved - extent;
  result.upper = moved + extent;
  return std::isfinite(glm::dot(glm::vec3(result.lower), glm::vec3(result.upper)) * 0.0f) ? result : WideBox{};
}

RenderList Collector::collect(const vrml::SceneGraph& scene) {
  auto& open = open_nodes_[&scene];
  open.resize(scene.nodes().count() + 1);
  list_.budget = budget_;
  list_.world_from_frame.emplace_back(1.0);
  if (sources_) {
    *sources_ = {};
    sources_->frames.emplace_back();
  }
  Frame roots{&scene, &open, 0, scene.roots().begin(), scene.roots().end(), dmat4(1), {}, true};
  roots.content_before = SIZE_MAX;  // never remove the coordinate system of the world
  enter(roots);
  bool stopped = false;
  while (!path_.empty()) {
    Frame& top = path_.back();
    if (top.next == top.end || stopped) {
      leave();
      continue;
    }
    if (++visits_ % kBetweenLooks == 0 || resources_.clear_made_mesh()) stopped = budget_->stopped();
    if (visits_ > budget_->limits().visits) {
      stopped = true;
      resources_.report_limit("more nodes, including copies by USE, than the " +
                                  std::to_string(budget_->limits().visits) + " that one picture may visit",
                              *top.scene, *top.next);
      continue;
    }
    const vrml::NodeId id = *top.next++;
    if (path_.size() == 1 && is_outside_of_layer(bound_, scene, id)) continue;
    visit(Frame(top), id);  // a copy, because enter() may reallocate path_
  }
  room_.coarsen_primitives(list_);
  if (sources_) {
    sources_->layouts = std::move(layouts_);
    sources_->clips = std::move(clips_);
  }
  for (ViewpointState& viewpoint : inlined_viewpoints_) list_.viewpoints.push_back(std::move(viewpoint));
  take_distances(list_, bound_ ? bound_->viewpoint : nullptr);
  if (sources_)
    sources_->viewpoints.insert(sources_->viewpoints.end(), inlined_sources_.begin(), inlined_sources_.end());
  list_.limit_reports = std::move(resources_.limit_reports());
  resources_.limit_reports().clear();
  return std::move(list_);
}

std::uint32_t Collector::add_place(const Frame& parent, vrml::NodeId id) {
  if (list_.places.size() >= kMaxPlaces || list_.world_from_frame.size() >= kMaxPlaces) return kNoPlace;
  list_.places.push_back({parent.scene, id, parent.place, parent.frame});
  return static_cast<std::uint32_t>(list_.places.size() - 1);
}

void Collector::enter(Frame frame) {
  if (path_.size() >= kMaxDepth) return;
  frame.outside = scoped_.mark();
  if (frame.node) {
    frame.opened = !(*frame.on_path)[frame.node];  // if false, an outer frame will clear the mark
    (*frame.on_path)[frame.node] = true;
  }
  // A DirectionalLight affects all its siblings, also those before it (VRML97 6.16).
  const bool is_layer_root = path_.empty() && bound_ && bound_->layer > 0;
  for (const vrml::NodeId* child = frame.next; child != frame.end && frame.presence.visible && !is_layer_root; ++child)
    add_scoped(frame, *child);
  path_.push_back(frame);
}

// Adds a node that affects its siblings and what is below them: a DirectionalLight, another light that is not global, a
// ClipPlane or LocalFog.
void Collector::add_scoped(Frame& frame, vrml::NodeId child) {
  const NodeView view = schemas_.view(*frame.scene, child);
  switch (view.kind()) {
    case NodeKind::directional_light:
    case NodeKind::point_light:
    case NodeKind::spot_light:
      if (!frame.presence.hidden && is_listed_light(view)) add_light(view, frame.world_from_local, frame.frame, true);
      break;
    case NodeKind::clip_plane:
      if (!view.get(ClipPlaneFields::enabled, true) || list_.clip_planes.size() >= kMaxScoped) break;
      scoped_.add_plane(list_.clip_planes.size());
      list_.clip_planes.push_back(world_clip_plane(view, frame.world_from_local));
      if (sources_) sources_->clip_planes.push_back({view.node, frame.frame});
      break;
    case NodeKind::local_fog:
      if (!view.get(LocalFogFields::enabled, true) || list_.local_fogs.size() >= kMaxScoped) break;
      frame.presence.local_fog = static_cast<std::uint16_t>(list_.local_fogs.size());
      list_.local_fogs.push_back(world_fog(view, frame.world_from_local));
      if (sources_) sources_->local_fogs.push_back({view.node, frame.frame});
      break;
    default:
      break;
  }
}

void Collector::leave() {
  const Frame& top = path_.back();
  if (top.opened) (*top.on_path)[top.node] = false;
  if (top.boxed) add_box(*top.boxed, top.world_from_local, top.first_item, top.place, top.presence);
  scoped_.return_to(top.outside);
  if (content_of(list_) + others_ == top.content_before) {
    // The group draws nothing, so remove its paths. Hostile worlds have millions of such groups.
    list_.places.resize(top.places_before);
    list_.world_from_frame.resize(top.frames_before);
    while (!layouts_.empty() && layouts_.back().frame >= top.frames_before) layouts_.pop_back();
    if (sources_) {
      sources_->frames.resize(top.frames_before);
      while (!sources_->billboards.empty() && sources_->billboards.back() >= top.frames_before)
        sources_->billboards.pop_back();
    }
  } else if (sources_ && (top.frame >= top.frames_before || path_.size() == 1)) {
    RenderSources::Frame& frame = sources_->frames[top.frame];
    frame.end = static_cast<std::uint32_t>(sources_->frames.size());
    frame.end_item = static_cast<std::uint32_t>(list_.items.size());
    frame.end_splat = static_cast<std::uint32_t>(list_.splats.size());
    frame.end_light = static_cast<std::uint32_t>(list_.lights.size());
  }
  path_.pop_back();
}

// Returns the frame of a node's children, in the coordinate system of `parent`.
Collector::Frame Collector::frame_below(const Frame& parent, vrml::NodeId id, std::span<const vrml::NodeId> children) {
  Frame frame{parent.scene,
              parent.on_path,
              id.index,
              children.data(),
              children.data() + children.size(),
              parent.world_from_local,
              {},
              parent.main};
  frame.frame = parent.frame;
  frame.presence = parent.presence;
  frame.places_before = static_cast<std::uint32_t>(list_.places.size());
  frame.frames_before = static_cast<std::uint32_t>(list_.world_from_frame.size());
  frame.content_before = content_of(list_) + others_;
  frame.place = add_place(parent, id);
  frame.first_item = list_.items.size();
  const vrml::Node& node = parent.scene->node(id);
  if (node.type->language == vrml::Language::x3d && !parent.presence.hidden) {
    const NodeView view{&node, &schemas_.of(*node.type)};
    if (view.flag(view.schema->box_display, false)) frame.boxed = &node;
  }
  return frame;
}

void Collector::visit(const Frame& given, vrml::NodeId id) {
  Frame inside;
  const bool begins = !given.presence.overlay && given.scene->contains(id) && begins_overlay(*given.scene, id);
  if (begins) {
    inside = given;
    inside.presence.overlay = true;
  }
  id = given.scene->resolve(id);
  if (!id || (*given.on_path)[id.index]) return;
  const vrml::Node& node = given.scene->node(id);
  const NodeView view{&node, &schemas_.of(*node.type)};
  const bool hides = !view.flag(view.schema->visible, true);
  if (hides) {
    if (!begins) inside = given;
    inside.presence.hidden = true;
  }
  const Frame& parent = begins || hides ? inside : given;
  if (node.type == &vrml::imported_use_type()) return enter_inline(parent, id);
  const dmat4& world = parent.world_from_local;
  switch (view.kind()) {
    case NodeKind::shape:
      if (!parent.presence.hidden) add_shape(parent, id, view);
      break;
    case NodeKind::particle_system:
      if (!parent.presence.hidden) add_particles(parent, id, view);
      break;
    case NodeKind::volume_data:
    case NodeKind::segmented_volume:
    case NodeKind::iso_surface_volume:
      if (!parent.presence.hidden) add_volume(parent, id);
      break;
    case NodeKind::cad_face:
      if (const auto* shape = view.find<vrml::SFNode>(CadFaceFields::shape))
        enter(frame_below(parent, id, std::span(shape, 1)));
      break;
    case NodeKind::layer_set:
      enter_layers(parent, id, view);
      break;
    case NodeKind::group:
      if (const auto* shown = view.find_at<vrml::MFBool>(view.schema->visible)) {
        enter_parts(parent, id, view.find<vrml::MFNode>(GroupFields::children), *shown);
        break;
      }
      [[fallthrough]];
    case NodeKind::layer:
      enter_node(parent, id, view.find<vrml::MFNode>(GroupFields::children));
      break;
    case NodeKind::viewport: {
      Frame clipped = parent;
      clip_to(clipped.presence, vrml::clip_boundary_of_viewport(*parent.scene, id));
      enter_node(clipped, id, view.find<vrml::MFNode>(GroupFields::children));
      break;
    }
    case NodeKind::layout_group:
    case NodeKind::layout_layer:
      enter_layout(parent, id, view);
      break;
    case NodeKind::collision:
      enter_collision(parent, id, view);
      break;
    case NodeKind::transform:
      enter_moved(parent, id, view.find<vrml::MFNode>(TransformFields::children), transform_matrix(view), false);
      break;
    case NodeKind::geo_group:
      enter_moved(parent, id, view.find<vrml::MFNode>(GroupFields::children),
                  node.type->behaviour->parent_from_local(*parent.scene, node), false);
      break;
    case NodeKind::geo_lod: {
      const vrml::GeoTiles* const tiles = parent.scene->inlines().tiles_of(id);
      const vrml::MFNode* const shown = tiles ? tiles->shown() : nullptr;
      enter_node(parent, id, shown ? shown : view.find<vrml::MFNode>(GroupFields::children));
      break;
    }
    case NodeKind::humanoid:
      enter_humanoid(parent, id, view);
      break;
    case NodeKind::billboard:
      enter_moved(parent, id, view.find<vrml::MFNode>(BillboardFields::children),
                  billboard_matrix(view, vrml::viewer_in_local(viewer_, world),
                                   vrml::direction_in_local(sight_.orientation[1], world)),
                  true);
      break;
    case NodeKind::screen_group:
      enter_moved(parent, id, view.find<vrml::MFNode>(GroupFields::children),
                  screens_.of(parent.presence.overlay).in_pixels(world, 1), true);
      break;
    case NodeKind::switch_node:
      enter_choice(parent, id, view.find<vrml::MFNode>(SwitchFields::choice),
                   view.get<vrml::SFInt32>(SwitchFields::which_choice, -1));
      break;
    case NodeKind::lod: {
      const int level = lod_level(view, vrml::viewer_in_local(viewer_, world));
      ++others_;
      if (sources_) sources_->lods.push_back({&node, parent.frame, level});
      enter_choice(parent, id, view.find<vrml::MFNode>(LodFields::level), level);
      break;
    }
    case NodeKind::inline_node:
      enter_inline(parent, id);
      break;
    case NodeKind::directional_light:
    case NodeKind::point_light:
    case NodeKind::spot_light:
      // enter() has handled the lights of this group.
      if (parent.presence.visible && !parent.presence.hidden && !is_listed_light(view))
        add_light(view, world, parent.frame, false);
      break;
    case NodeKind::sound:
      if (parent.presence.visible && list_.sounds.size() < kMaxSounds) {
        ++others_;
        list_.sounds.push_back({parent.scene, id, parent.frame});
      }
      break;
    case NodeKind::viewpoint_group:
      enter_viewpoint_group(parent, id, view);
      break;
    case NodeKind::viewpoint:
    case NodeKind::navigation_info:
    case NodeKind::background:
    case NodeKind::fog:
      if (parent.presence.visible) add_bindable(view, id, parent);
      break;
    default:
      break;
  }
}

void Collector::add_light(const NodeView& light, const dmat4& world_from_local, std::uint32_t frame, bool listed) {
  if (!light.get(LightFields::on, true) || list_.lights.size() >= kMaxLights) return;
  if (listed) scoped_.add_light(list_.lights.size());
  list_.lights.push_back(world_light(light, world_from_local));
  if (sources_) sources_->lights.push_back({light.node, frame});
}

// Returns the planes of the innermost Viewport, and the active ClipPlanes.
const ClipList& Collector::clip_planes(const Presence& presence) {
  if (presence.clip == kNoPlace) return scoped_.planes(std::nullopt);
  return scoped_.planes(clips_[presence.clip].first_plane);
}

void Collector::add_bindable(const NodeView& view, vrml::NodeId id, const Frame& parent) {
  ++others_;
  if (view.kind() == NodeKind::viewpoint) {
    auto& viewpoints = parent.main ? list_.viewpoints : inlined_viewpoints_;
    if (viewpoints.size() >= kMaxViewpoints) return;
    viewpoints.push_back(world_viewpoint(*parent.scene, view, parent.world_from_local));
    viewpoints.back().scene = parent.scene;
    take_group(viewpoints.back(), viewpoint_groups_[parent.presence.viewpoint_group]);
    viewpoints.back().node = id;
    if (sources_)
      (parent.main ? sources_->viewpoints : inlined_sources_).push_back({view.node, parent.frame, parent.main});
    // A viewpoint may have a NavigationInfo (X3D 23.3.1). Without events, only the first viewpoint is bound.
    const auto* info = view.find<vrml::SFNode>(ViewpointFields::navigation_info);
    if (!info || (!bound_ && viewpoints.size() > 1)) return;
    const NodeView given = schemas_.view(*parent.scene, *info);
    if (given.kind() == NodeKind::navigation_info) add_bindable(given, parent.scene->resolve(*info), parent);
    return;
  }
  if (sources_ && sources_->bindables.size() < kMaxViewpoints)
    sources_->bindables.push_back({view.node, parent.frame, parent.main, parent.scene});
  const NodeKind kind = view.kind();
  const vrml::Node* bound = !bound_                        ? nullptr
                            : kind == NodeKind::background ? bound_->background
                            : kind == NodeKind::fog        ? bound_->fog
                                                           : bound_->navigation_info;
  bool& have = kind == NodeKind::background ? have_background_ : kind == NodeKind::fog ? have_fog_ : have_navigation_;
  // A bindable node in an Inline is not bound at the start (VRML97 4.6.10).
  const bool counts = bound_ ? view.node == bound : parent.main;
  if (!counts || std::exchange(have, true)) return;
  if (kind == NodeKind::background) {
    list_.background = world_background(view, parent.world_from_local, resources_.images());
    list_.has_background = true;
    resources_.add_faces(list_.background, *parent.scene, view);
  } else if (kind == NodeKind::fog) {
    list_.fog = world_fog(view, parent.world_from_local);
  } else {
    list_.navigation = navigation_state(view);
    list_.has_navigation = true;
  }
}

RenderList collect(const vrml::SceneGraph& scene, const Images& images, MeshCache& meshes, const glm::dvec3& viewer,
                   const Geometries& geometries, const BoundNodes* bound, const Sight& sight) {
  const bool usable = std::isfinite(viewer.x) && std::isfinite(viewer.y) && std::isfinite(viewer.z);
  ShapeResources resources(images, meshes, scene.budget());
  return Collector(resources, usable ? viewer : glm::dvec3(0, 0, 10), geometries, bound, scene.budget(), nullptr, sight)
      .collect(scene);
}

}  // namespace gs::render
