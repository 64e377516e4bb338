#pragma once

#include "render/collection/nodes/screen.h"
#include "render/collection/picture_room.h"
#include "render/collection/scoped_nodes.h"
#include "render/collection/shapes/shape_resources.h"
#include "render/scene/render_list.h"
#include "vrml/behaviours/particles/particle_mesh.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::render {

/// Source nodes of the parts of a RenderList, for incremental updates. All arrays are in traversal order. So the
/// content of a frame is one range of each array.
struct RenderSources {
  /// Coordinate system of a Transform or Billboard. The first frame is that of the world.
  struct Frame {
    const vrml::Node* node = nullptr;   // null for the frame of the world
    std::uint32_t parent = 0, end = 0;  // `end`: index after the last frame inside this frame
    std::uint32_t first_item = 0, end_item = 0, first_splat = 0, end_splat = 0, first_light = 0, end_light = 0;
    glm::dmat4 parent_from_local{1.0};
    bool overlay = false;  // its content is fixed to the viewer
  };
  struct Item {
    const vrml::Node* geometry = nullptr;
    ShapeResources::AppearanceNodes appearance;
    glm::vec3 scale{1.0f};  // scale of a shared default primitive
    WideBox bounds;         // in world space
    Box region;             // of a particle system, in node space: box of all its particles so far; else empty
    std::uint8_t text_level = 0;
  };
  struct Particles {  // Item with the particles of a ParticleSystem, and the state for which its mesh was made.
    std::uint32_t item = 0;
    bool sprites = false;  // the mesh depends on the viewer
    vrml::ParticleView view;
    const void* simulation = nullptr;
    double moment = 0;
    std::shared_ptr<Share> share;  // part of the budget for the mesh
  };
  struct Volume {  // Item with a volume of X3D, and the nodes that determine its look.
    std::uint32_t item = 0;
    std::vector<const vrml::Node*> nodes;
  };
  struct Local {  // Source of a light, Viewpoint, NavigationInfo, Background or Fog.
    const vrml::Node* node = nullptr;
    std::uint32_t frame = 0;
    bool main = true;                         // true if not inside of an Inline
    const vrml::SceneGraph* scene = nullptr;  // scene of a bindable node
  };
  struct Unshown {  // Geometry or Transform that draws nothing in its current state.
    const vrml::Node* node = nullptr;
    const vrml::SceneGraph* scene = nullptr;
  };
  struct Lod {
    const vrml::Node* node = nullptr;
    std::uint32_t frame = 0;
    int level = -1;
  };

  struct Layout {                      // LayoutGroup or LayoutLayer with a Layout. Outer ones stand before inner ones.
    const vrml::Node* node = nullptr;  // the Layout
    std::uint32_t frame = 0;
    std::uint32_t outer = kNoPlace;  // index of the Layout around it
    std::uint32_t depth = 0;         // number of Layouts around it
    Screen::Anchor anchor = Screen::Anchor::layout;
    glm::dvec2 size{0};  // pixels of its rectangle
  };
  struct BoxItem {  // Item that shows the box of a node with bboxDisplay TRUE
    std::uint32_t item = 0;
    std::uint32_t first = 0;  // the box contains the items from `first` up to `item`
  };
  struct Clip {                     // Viewport of a LayoutGroup
    std::uint32_t first_plane = 0;  // of four, in the order of ClipBoundary
    vrml::ClipBoundary part{};      // part of the whole picture, inside of the Viewports around it
    bool overlay = false;
  };

  std::vector<Frame> frames;
  std::vector<Layout> layouts;
  std::vector<Clip> clips;
  std::vector<BoxItem> boxes;  // inner boxes stand before outer ones
  std::vector<Item> items, splats;
  std::vector<Local> lights, viewpoints, bindables;  // lights and viewpoints are in the order of the list
  std::vector<Local> clip_planes, local_fogs;        // in the order of the list
  std::vector<Lod> lods;
  std::vector<std::uint32_t> billboards;  // indexes of frames
  std::vector<std::uint32_t> texts;       // indexes of items
  std::vector<Particles> particles;
  std::vector<Volume> volumes;   // by item
  std::vector<Unshown> unshown;  // may contain a node more than once
  bool complete = true;          // false if the world has more coordinate systems than the list can store
};

/// Maximum paths and coordinate systems; further content has no path.
inline constexpr std::size_t kMaxPlaces = std::size_t{1} << 20;
inline constexpr std::size_t kMaxViewpoints = 10'000;  // also limits bindable nodes and ViewpointGroups

/// Pictures of the content of a layer, and of its overlays, which are always in perspective.
struct Screens {
  Screens(const glm::dvec3& viewer, const Sight& sight, const vrml::ClipBoundary& boundary);
  Screen content, overlays;
  [[nodiscard]] const Screen& of(bool overlay) const { return overlay ? overlays : content; }
  /// Returns the place of a Layout. `values` are its fields, and `parent` is the coordinate system around it.
  [[nodiscard]] Screen::Placement place(const RenderSources::Layout& layout, const LayoutValues& values,
                                        std::span<const RenderSources::Layout> all, bool overlay,
                                        const glm::dmat4& parent) const;
};

/// Traverses a scene and collects its visible content, as collect() describes.
class Collector {
 public:
  /// Prepares a traversal. `sources` receives the source nodes; it may be null.
  Collector(ShapeResources& resources, const glm::dvec3& viewer, const Geometries& geometries, const BoundNodes* bound,
            std::shared_ptr<Budget> budget, RenderSources* sources, const Sight& sight = {})
      : resources_(resources),
        schemas_(resources.schemas()),
        viewer_(viewer),
        geometries_(geometries),
        bound_(bound),
        sources_(sources),
        budget_(budget),
        sight_(sight),
        screens_(viewer, sight, bound ? bound->boundary : kWholePicture),
        room_(resources, std::move(budget)) {}

  RenderList collect(const vrml::SceneGraph& scene);

 private:
  /// Visibility that a node inherits from the grouping nodes above it.
  struct Presence {
    bool overlay = false;    // true for content that is fixed to the viewer
    bool visible = true;     // false in the proxy of a Collision, which is collidable but invisible
    bool collidable = true;  // false in a Collision with collide FALSE (6.8)
    bool hidden = false;     // in a group with `visible` FALSE: neither visible nor collidable (X3D 10.2.1)
    std::uint16_t local_fog = kNoLocalFog;
    std::uint32_t layout = kNoPlace;  // index in layouts_ of the innermost Layout; kNoPlace means none
    std::uint32_t clip = kNoPlace;    // index in clips_ of the innermost Viewport of a LayoutGroup
    bool in_layout_layer = false;
    std::uint32_t viewpoint_group = 0;  // index in viewpoint_groups_ of the innermost ViewpointGroup; 0 means none
  };
  /// Grouping node on the current path, or the root nodes of a scene.
  struct Frame {
    const vrml::SceneGraph* scene;
    std::vector<bool>* on_path;  // by node index of the scene: true for nodes on the current path
    std::uint32_t node;          // index of the grouping node; 0 for root nodes
    const vrml::NodeId* next;
    const vrml::NodeId* end;
    glm::dmat4 world_from_local;
    ScopedNodes::Mark outside;  // active nodes before this group
    bool main;                  // true if not inside of an Inline
    Presence presence{};
    const vrml::Node* boxed = nullptr;  // node of this group, if its box is displayed
    std::size_t first_item = 0;         // number of items before this group
    bool opened = false;                // this frame has set on_path for its node
    std::uint32_t place = kNoPlace, frame = 0;
    std::uint32_t places_before = 0, frames_before = 0;
    std::size_t content_before = 0;
  };

  Frame frame_below(const Frame& parent, vrml::NodeId id, std::span<const vrml::NodeId> children);
  void enter(Frame frame);
  void enter_node(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children);
  void enter_moved(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children, const glm::dmat4& local,
                   bool billboard);
  void enter_layout(const Frame& parent, vrml::NodeId id, const NodeView& group);
  void clip_to(Presence& presence, vrml::ClipBoundary part);
  void begin_frame(Frame& frame, const Frame& parent, const vrml::Node& node, const glm::dmat4& local, bool billboard);
  void enter_parts(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children, const vrml::MFBool& shown);
  void enter_humanoid(const Frame& parent, vrml::NodeId id, const NodeView& humanoid);
  void enter_choice(const Frame& parent, vrml::NodeId id, const vrml::MFNode* choices, std::int64_t which);
  void enter_inline(const Frame& parent, vrml::NodeId id);
  void enter_collision(const Frame& parent, vrml::NodeId id, const NodeView& collision);
  void leave();
  void visit(const Frame& parent, vrml::NodeId id);
  void enter_layers(const Frame& parent, vrml::NodeId id, const NodeView& layer_set);
  [[nodiscard]] const ClipList& clip_planes(const Presence& presence);
  void add_box(const vrml::Node& node, const glm::dmat4& world_from_local, std::size_t first_item, std::uint32_t place,
               const Presence& presence);
  void add_scoped(Frame& frame, vrml::NodeId child);
  void add_light(const NodeView& light, const glm::dmat4& world_from_local, std::uint32_t frame, bool listed);
  void add_bindable(const NodeView& view, vrml::NodeId id, const Frame& parent);
  void add_shape(const Frame& parent, vrml::NodeId id, const NodeView& shape);
  void add_screen_text(const Frame& parent, vrml::NodeId id, vrml::NodeId geometry, DrawItem item,
                       const RenderSources::Item& source);
  void add_particles(const Frame& parent, vrml::NodeId id, const NodeView& system);
  void add_volume(const Frame& parent, vrml::NodeId id);
  void add_item(const Frame& parent, vrml::NodeId id, vrml::NodeId geometry, DrawItem item, RenderSources::Item source,
                const glm::dmat4& world_from_node);
  void add_splats(const Frame& parent, vrml::NodeId id, const DrawItem& shape,
                  const std::shared_ptr<const qnv::Geometry>& splats, float detail, const RenderSources::Item& source);
  std::uint32_t add_place(const Frame& parent, vrml::NodeId id);
  void enter_viewpoint_group(const Frame& parent, vrml::NodeId id, const NodeView& group);

  ShapeResources& resources_;
  Schemas& schemas_;
  glm::dvec3 viewer_;
  const Geometries& geometries_;
  const BoundNodes* bound_;
  RenderSources* sources_;
  RenderList list_;
  std::vector<ViewpointState> inlined_viewpoints_;
  std::vector<RenderSources::Local> inlined_sources_;
  std::vector<ViewpointState> viewpoint_groups_{1};  // values for the Viewpoints of each ViewpointGroup; 0 is no group
  std::size_t others_ = 0;                           // number of viewpoints, bindable nodes and LODs so far
  bool have_navigation_ = false, have_background_ = false, have_fog_ = false;
  std::vector<Frame> path_;
  std::unordered_map<const vrml::SceneGraph*, std::vector<bool>> open_nodes_;
  std::deque<vrml::MFNode> joined_;  // children of nodes with several lists of them; frames refer to these lists
  ScopedNodes scoped_;
  std::vector<RenderSources::Layout> layouts_;
  std::vector<RenderSources::Clip> clips_;
  std::size_t visits_ = 0;
  std::shared_ptr<Budget> budget_;
  Sight sight_;
  Screens screens_;
  PictureRoom room_;
};

/// Makes the mesh of a particle system again for a viewer in world space, if its particles or the viewer have changed.
/// Returns true if the item has changed. `world` is the coordinate system of the node `system`.
bool renew_particles(DrawItem& item, RenderSources::Item& source, RenderSources::Particles& particles,
                     const vrml::SceneGraph& scene, vrml::NodeId system, const glm::dmat4& world,
                     const glm::dvec3& viewer, const glm::dvec3& up);
/// Returns the box of the items from `first` up to `end` in a coordinate system.
[[nodiscard]] Box box_of_items(const RenderList& list, std::size_t first, std::size_t end,
                               const glm::dmat4& world_from_local);
/// Returns a mesh with the twelve edges of a box.
[[nodiscard]] std::shared_ptr<const vrml::Mesh> edges_of(const Box& box);
/// Makes the look of a volume data node of X3D (clause 41), and sets the scale of its box. Returns false if the node
/// draws nothing in its state.
bool renew_volume(ShapeResources& resources, DrawItem& item, RenderSources::Item& source, RenderSources::Volume& volume,
                  const vrml::SceneGraph& scene, vrml::NodeId id);
/// Reports whether all elements are finite and within the range of float.
[[nodiscard]] bool fits_float(const glm::dmat4& matrix);
/// Returns the matrix from positions of a mesh, relative to its origin, to world space.
[[nodiscard]] glm::dmat4 world_from_mesh(const glm::dmat4& world_from_node, const vrml::Mesh& mesh);
/// Returns the matrix from positions of a geometry, relative to its origin, to world space.
[[nodiscard]] glm::dmat4 world_from_geometry(const glm::dmat4& world_from_node, const qnv::Geometry& geometry);

}  // namespace gs::render
