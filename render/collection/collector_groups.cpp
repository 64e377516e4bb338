#include "render/collection/collector.h"
#include "vrml/event_model/behaviour.h"
#include "vrml/scene/imported_use.h"

#include <algorithm>
#include <span>
#include <utility>

// The part of the Collector that enters grouping nodes.
namespace gs::render {

using glm::dmat4;

Screens::Screens(const glm::dvec3& viewer, const Sight& sight, const vrml::ClipBoundary& boundary)
    : content(viewer, sight, boundary),
      overlays(
          viewer,
          [&] {
            Sight perspective = sight;
            perspective.height = 0;
            return perspective;
          }(),
          boundary) {}

Screen::Placement Screens::place(const RenderSources::Layout& layout, const LayoutValues& values,
                                 std::span<const RenderSources::Layout> all, bool overlay, const dmat4& parent) const {
  const Screen& screen = of(overlay);
  return screen.place(values, layout.anchor, layout.outer == kNoPlace ? screen.size() : all[layout.outer].size, parent);
}

void Collector::enter_node(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children) {
  if (children && !children->empty()) enter(frame_below(parent, id, children->span()));
}

void Collector::enter_moved(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children, const dmat4& local,
                            bool billboard) {
  if (!children || children->empty()) return;
  const dmat4 world_from_local = parent.world_from_local * local;
  if (!fits_float(world_from_local)) {
    if (sources_) sources_->unshown.push_back({&parent.scene->node(id), parent.scene});
    return;
  }
  Frame frame = frame_below(parent, id, children->span());
  frame.world_from_local = world_from_local;
  // Above the limit of coordinate systems, content has no path. Each change then collects everything again.
  if (frame.place != kNoPlace) {
    begin_frame(frame, parent, parent.scene->node(id), local, billboard);
    list_.places[frame.place].frame = frame.frame;
  } else if (sources_) {
    sources_->complete = false;
  }
  enter(frame);
}

// Begins the coordinate system of a node; `local` is parent_from_local. The caller sets its end.
void Collector::begin_frame(Frame& frame, const Frame& parent, const vrml::Node& node, const dmat4& local,
                            bool billboard) {
  frame.frame = static_cast<std::uint32_t>(list_.world_from_frame.size());
  list_.world_from_frame.push_back(frame.world_from_local);
  if (!sources_) return;
  RenderSources::Frame source;
  source.node = &node;
  source.parent = parent.frame;
  source.first_item = static_cast<std::uint32_t>(list_.items.size());
  source.first_splat = static_cast<std::uint32_t>(list_.splats.size());
  source.first_light = static_cast<std::uint32_t>(list_.lights.size());
  source.parent_from_local = local;
  source.overlay = parent.presence.overlay;
  sources_->frames.push_back(source);
  if (billboard) sources_->billboards.push_back(frame.frame);
}

// Enters the children of a CADLayer of X3D 3, which shows each child or not (ISO/IEC 19775-1:2013 32.4.3). Children
// without a value are shown.
void Collector::enter_parts(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children,
                            const vrml::MFBool& shown) {
  if (!children) return;
  vrml::MFNode &seen = joined_.emplace_back(), &hidden = joined_.emplace_back();
  for (std::size_t i = 0; i < children->size(); ++i)
    (i < shown.size() && !shown[i] ? hidden : seen).push_back((*children)[i]);
  Frame inside = parent;
  inside.presence.hidden = true;
  enter_node(inside, id, &hidden);
  enter_node(parent, id, &seen);
}

// Enters the skeleton and the skin of an HAnimHumanoid as one list.
void Collector::enter_humanoid(const Frame& parent, vrml::NodeId id, const NodeView& humanoid) {
  vrml::MFNode& parts = joined_.emplace_back();
  for (const int field : {HumanoidFields::skeleton, HumanoidFields::skin})
    if (const auto* list = humanoid.find<vrml::MFNode>(field))
      for (const vrml::NodeId part : *list) parts.push_back(part);
  enter_moved(parent, id, &parts, transform_matrix(humanoid), false);
}

// Enters the collected layer. Without events, and in Inlines, enters all layers as a group.
void Collector::enter_layers(const Frame& parent, vrml::NodeId id, const NodeView& layer_set) {
  const auto* layers = layer_set.find<vrml::MFNode>(LayerSetFields::layers);
  if (bound_ && id == bound_->layer_set && parent.main)
    enter_choice(parent, id, layers, bound_->layer - 1);
  else
    enter_node(parent, id, layers);
}

void Collector::enter_choice(const Frame& parent, vrml::NodeId id, const vrml::MFNode* choices, std::int64_t which) {
  if (!choices || which < 0 || which >= static_cast<std::int64_t>(choices->size())) return;
  enter(frame_below(parent, id, std::span(choices->begin() + which, 1)));
}

// Enters a LayoutGroup or LayoutLayer (X3D 36.4.2, 36.4.3).
void Collector::enter_layout(const Frame& parent, vrml::NodeId id, const NodeView& group) {
  using Anchor = Screen::Anchor;
  constexpr std::uint32_t kMaxDepthOfLayouts = 64;  // each level moves all content below it again
  constexpr std::size_t kMaxLayouts = 10'000;
  const auto* children = group.find<vrml::MFNode>(LayoutGroupFields::children);
  const auto* given = group.find<vrml::SFNode>(LayoutGroupFields::layout);
  const NodeView layout = given ? schemas_.view(*parent.scene, *given) : NodeView{};
  Frame inside = parent;
  Presence& presence = inside.presence;
  const bool in_layer = presence.in_layout_layer || group.kind() == NodeKind::layout_layer;
  presence.in_layout_layer = in_layer;
  RenderSources::Layout made;
  made.node = layout.node;
  made.frame = static_cast<std::uint32_t>(list_.world_from_frame.size());
  made.outer = presence.layout;
  made.anchor = made.outer != kNoPlace ? Anchor::layout : in_layer ? Anchor::layer : Anchor::viewer;
  made.depth = made.outer != kNoPlace ? layouts_[made.outer].depth + 1 : 0;
  const bool placed = layout.kind() == NodeKind::layout && made.depth < kMaxDepthOfLayouts &&
                      layouts_.size() < kMaxLayouts && children && !children->empty();
  if (placed && made.anchor == Anchor::viewer) presence.overlay = true;
  if (group.kind() == NodeKind::layout_group) clip_to(presence, vrml::clip_boundary_of(*parent.scene, id));
  if (!placed) return enter_node(inside, id, children);
  const Screen::Placement place =
      screens_.place(made, layout_values(layout), layouts_, presence.overlay, parent.world_from_local);
  made.size = place.size;
  presence.layout = static_cast<std::uint32_t>(layouts_.size());
  const bool fits = fits_float(parent.world_from_local * place.parent_from_local);
  if (fits) layouts_.push_back(made);
  enter_moved(inside, id, children, place.parent_from_local, false);
}

// Clips content to the part of the picture that a Viewport covers (X3D 35.4.4), inside of those around it.
void Collector::clip_to(Presence& presence, vrml::ClipBoundary part) {
  constexpr std::size_t kMaxPlanes = 60'000;  // DrawItem stores indexes in 16 bits
  if (part == kWholePicture || list_.clip_planes.size() + part.size() > kMaxPlanes) return;
  if (presence.clip != kNoPlace) {
    const vrml::ClipBoundary& around = clips_[presence.clip].part;
    for (std::size_t edge = 0; edge < part.size(); ++edge)
      part[edge] = edge % 2 == 0 ? std::max(part[edge], around[edge]) : std::min(part[edge], around[edge]);
  }
  presence.clip = static_cast<std::uint32_t>(clips_.size());
  clips_.push_back({static_cast<std::uint32_t>(list_.clip_planes.size()), part, presence.overlay});
  for (const glm::dvec4& plane : screens_.of(presence.overlay).planes(part)) {
    list_.clip_planes.push_back(plane);
    if (sources_) sources_->clip_planes.push_back({});
  }
}

// Enters a Collision. With a proxy, the children are visible but not collidable, and the proxy is collidable but
// invisible (6.8).
void Collector::enter_collision(const Frame& parent, vrml::NodeId id, const NodeView& collision) {
  const auto* children = collision.find<vrml::MFNode>(CollisionFields::children);
  const auto* proxy = collision.find<vrml::SFNode>(CollisionFields::proxy);
  Frame inside = parent;
  if (!collision.get(CollisionFields::collide, true)) {
    inside.presence.collidable = false;
    enter_node(inside, id, children);
    return;
  }
  if (!proxy || !parent.scene->resolve(*proxy)) {
    enter_node(inside, id, children);
    return;
  }
  // Enter the proxy first: the frame that is entered last, with the children, is visited first.
  inside.presence.visible = false;
  enter(frame_below(inside, id, std::span(proxy, 1)));
  inside.presence = parent.presence;
  inside.presence.collidable = false;
  enter_node(inside, id, children);
}

// Enters a ViewpointGroup (X3D 23.4.7).
void Collector::enter_viewpoint_group(const Frame& parent, vrml::NodeId id, const NodeView& group) {
  if (viewpoint_groups_.size() >= kMaxViewpoints) return;
  ViewpointState state = viewpoint_groups_[parent.presence.viewpoint_group];
  add_group(state, group, parent.world_from_local);
  Frame inside = parent;
  inside.presence.viewpoint_group = static_cast<std::uint32_t>(viewpoint_groups_.size());
  viewpoint_groups_.push_back(std::move(state));
  enter_node(inside, id, group.find<vrml::MFNode>(ViewpointGroupFields::children));
}

// Enters the content of an Inline. Of a node that stands for an imported node, enters only that node.
void Collector::enter_inline(const Frame& parent, vrml::NodeId id) {
  std::shared_ptr<vrml::SceneGraph> inlined;
  std::span<const vrml::NodeId> roots;
  if (parent.scene->node(id).type == &vrml::imported_use_type()) {
    const vrml::ExportedNode used =
        vrml::find_imported(*parent.scene, parent.scene->get<vrml::SFString>(id, "name").view());
    inlined = used.scene;
    if (inlined) roots = joined_.emplace_back(vrml::MFNode{used.node}).span();
  } else if (const auto found = parent.scene->inlines().all().find(id.index);
             found != parent.scene->inlines().all().end()) {
    inlined = found->second;
    if (inlined) roots = {inlined->roots().begin(), inlined->roots().end()};
  }
  if (roots.empty()) return;
  const auto [open, fresh] = open_nodes_.try_emplace(inlined.get());
  if (fresh) {
    open->second.resize(inlined->nodes().count() + 1);
    list_.scenes.push_back(inlined);
  }
  Frame frame = frame_below(parent, id, roots);
  frame.scene = inlined.get();
  frame.on_path = &open->second;
  frame.node = 0;
  frame.main = false;
  enter(frame);
}

}  // namespace gs::render
