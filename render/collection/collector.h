#pragma once

#include "render/collection/shape_resources.h"
#include "render/scene/render_list.h"

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::render {

/// Source nodes of a RenderList's parts, for incremental updates. Everything is in traversal order, so that the content
/// below a frame is one range of each array.
struct RenderSources {
  /// Coordinate system of a Transform or Billboard; the first one is the world's.
  struct Frame {
    const vrml::Node* node = nullptr;   // null means the world
    std::uint32_t parent = 0, end = 0;  // `end`: index after the last frame below this one
    std::uint32_t first_item = 0, end_item = 0, first_splat = 0, end_splat = 0, first_light = 0, end_light = 0;
    glm::dmat4 parent_from_local{1.0};
  };
  struct Item {
    const vrml::Node* geometry = nullptr;
    ShapeResources::AppearanceNodes appearance;
    glm::vec3 scale{1.0f};  // of a primitive with a shared default mesh
    WideBox bounds;         // world space
    std::uint8_t text_level = 0;
  };
  struct Local {  // source of a light, Viewpoint, NavigationInfo, Background or Fog
    const vrml::Node* node = nullptr;
    std::uint32_t frame = 0;
    bool main = true;  // not inside an Inline
  };
  struct Unshown {  // geometry or Transform that shows nothing in its present state
    const vrml::Node* node = nullptr;
    const vrml::SceneGraph* scene = nullptr;
  };
  struct Lod {
    const vrml::Node* node = nullptr;
    std::uint32_t frame = 0;
    int level = -1;
  };

  std::vector<Frame> frames;
  std::vector<Item> items, splats;
  std::vector<Local> lights, viewpoints, bindables;  // lights and viewpoints in the order of the list
  std::vector<Lod> lods;
  std::vector<std::uint32_t> billboards;  // indices of frames
  std::vector<std::uint32_t> texts;       // indices of items
  std::vector<Unshown> unshown;           // may contain duplicates
  bool complete = true;                   // false if there are more coordinate systems than are recorded
};

/// Traverses the scene and collects its visible content; see collect().
class Collector {
 public:
  /// `sources` receives the source nodes; null means none.
  Collector(ShapeResources& resources, const glm::dvec3& viewer, const Geometries& geometries, const BoundNodes* bound,
            std::shared_ptr<Budget> budget, RenderSources* sources, float pixels_per_radian = kUsualPixelsPerRadian,
            const glm::dvec3& viewer_up = {0, 1, 0})
      : resources_(resources),
        schemas_(resources.schemas()),
        viewer_(viewer),
        geometries_(geometries),
        bound_(bound),
        sources_(sources),
        budget_(std::move(budget)),
        pixels_per_radian_(pixels_per_radian),
        viewer_up_(viewer_up) {}

  RenderList collect(const vrml::SceneGraph& scene);

 private:
  /// Visibility state inherited from the grouping nodes above.
  struct Presence {
    bool overlay = false;    // fixed to the viewer
    bool visible = true;     // false inside the proxy of a Collision: collidable but invisible
    bool collidable = true;  // false below a Collision with collide FALSE (6.8)
  };
  /// Grouping node on the current path, or the roots of a scene.
  struct Frame {
    const vrml::SceneGraph* scene;
    std::vector<bool>* on_path;  // by node of the scene: nodes on the current path
    std::uint32_t node;          // index of the open node; 0 for roots
    const vrml::NodeId* next;
    const vrml::NodeId* end;
    glm::dmat4 world_from_local;
    std::size_t lights_outside;  // number of active_lights_ that are valid outside this group
    bool main;                   // not inside an Inline
    Presence presence{};
    bool opened = false;  // the node was not yet on the path
    std::uint32_t place = kNoPlace, frame = 0;
    std::uint32_t places_before = 0, frames_before = 0;
    std::size_t content_before = 0;
  };

  Frame frame_below(const Frame& parent, vrml::NodeId id, std::span<const vrml::NodeId> children);
  void enter(Frame frame);
  void enter_node(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children);
  void enter_moved(const Frame& parent, vrml::NodeId id, const vrml::MFNode* children, const glm::dmat4& local,
                   bool billboard);
  void enter_choice(const Frame& parent, vrml::NodeId id, const vrml::MFNode* choices, std::int64_t which);
  void enter_one(const Frame& parent, vrml::NodeId id, const vrml::NodeId& child);
  void enter_inline(const Frame& parent, vrml::NodeId id);
  void enter_collision(const Frame& parent, vrml::NodeId id, const NodeView& collision);
  void leave();
  void visit(const Frame& parent, vrml::NodeId id);
  const LightList& directional_lights();
  void add_light(const NodeView& light, const glm::dmat4& world_from_local, std::uint32_t frame, bool directional);
  void add_bindable(const NodeView& view, vrml::NodeId id, const Frame& parent);
  void add_shape(const Frame& parent, vrml::NodeId id, const NodeView& shape);
  bool surface_item(const vrml::SceneGraph& scene, vrml::NodeId geometry, bool pictured, DrawItem& item);
  void add_item(const Frame& parent, vrml::NodeId id, vrml::NodeId geometry, DrawItem item, RenderSources::Item source,
                const glm::dmat4& world_from_node);
  void add_splats(const Frame& parent, vrml::NodeId id, const DrawItem& shape,
                  const std::shared_ptr<const qnv::Geometry>& splats, float detail, const RenderSources::Item& source);
  bool has_room(const vrml::SceneGraph& scene, vrml::NodeId geometry, std::size_t triangles);
  bool charge_triangles(std::size_t count);
  void coarsen_primitives();
  [[nodiscard]] glm::dvec3 viewer_in(const glm::dmat4& world_from_local) const;
  [[nodiscard]] std::size_t content() const;
  std::uint32_t add_place(const Frame& parent, vrml::NodeId id);

  ShapeResources& resources_;
  Schemas& schemas_;
  glm::dvec3 viewer_;
  const Geometries& geometries_;
  const BoundNodes* bound_;
  RenderSources* sources_;
  RenderList list_;
  std::vector<ViewpointState> inlined_viewpoints_;
  std::vector<RenderSources::Local> inlined_sources_;
  std::size_t others_ = 0;  // viewpoints, bindable nodes and LODs encountered
  bool have_navigation_ = false, have_background_ = false, have_fog_ = false;
  std::vector<Frame> path_;
  std::unordered_map<const vrml::SceneGraph*, std::vector<bool>> open_nodes_;
  std::vector<std::uint16_t> active_lights_;
  LightList directional_lights_;  // list of the active directional lights, shared by the items of a group
  bool lights_changed_ = false;   // lights changed since that list was made
  std::size_t visits_ = 0;
  std::shared_ptr<Budget> budget_;
  float pixels_per_radian_;
  glm::dvec3 viewer_up_;
  std::size_t triangles_ = 0;  // of all items; primitives count at their coarsest level
  // Primitives with items, by their finest mesh.
  struct Primitives {
    std::array<std::shared_ptr<const vrml::Mesh>, ShapeResources::kSegments.size()> meshes;
    std::size_t count = 0;
  };
  std::unordered_map<const vrml::Mesh*, Primitives> primitives_;
};

/// Reports whether all elements are finite and fit a float.
[[nodiscard]] bool fits_float(const glm::dmat4& matrix);
/// Returns world space from a point set's positions, which are relative to its origin.
[[nodiscard]] glm::dmat4 world_from_geometry(const glm::dmat4& world_from_node, const qnv::Geometry& geometry);

}  // namespace gs::render
