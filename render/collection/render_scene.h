#pragma once

#include "render/collection/collector.h"
#include "render/collection/node_uses.h"
#include "render/collection/scene_layers.h"
#include "render/collection/shapes/shape_resources.h"
#include "render/scene/block_bounds.h"
#include "render/scene/render_list.h"
#include "vrml/events/execution.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::render {

/// RenderList of a world for one viewer. Collects the scene once and then applies changes, so that an update costs only
/// the changes. Moved Transforms and Billboards, lights, Viewpoints, colours, textures and geometries are updated in
/// place. Added or removed content causes a new collection.
///
/// The address of the list never changes. Runs on the scene's thread. All inputs must outlive this object.
class RenderScene {
 public:
  RenderScene(const vrml::SceneGraph& scene, const Images& images, const Geometries& geometries, MeshCache& meshes);

  /// Collects the whole scene.
  void gather(const BoundNodes& bound, const glm::dvec3& viewer);
  /// Applies the changes of nodes after the last call, and the viewer's position in world space. Returns true if the
  /// list changed. Call forget_changed() on the cache first.
  bool update(std::span<const vrml::NodeChange> changes, const BoundNodes& bound, const glm::dvec3& viewer);

  /// Sets the viewer's orientation, lens and picture for the next `gather` or `update`.
  void set_sight(const Sight& sight) { sight_ = sight; }

  [[nodiscard]] const RenderList& list() const { return *list_; }
  [[nodiscard]] std::shared_ptr<const RenderList> shared_list() const { return list_; }
  /// Reports whether the list depends on the viewer's position.
  [[nodiscard]] bool depends_on_viewer() const {
    return !sources_.lods.empty() || !sources_.billboards.empty() || !sources_.texts.empty() ||
           !sources_.particles.empty() || !sources_.layouts.empty() || !sources_.clips.empty();
  }
  /// Returns the number of full collections so far.
  [[nodiscard]] std::size_t gathered() const { return gathered_; }

 private:
  enum class Effect : std::uint8_t {
    none,
    frame,
    apply_appearance,
    geometry,
    light,
    scoped,
    viewpoint,
    bindable,
    everything
  };

  [[nodiscard]] Effect effect_of(const vrml::NodeChange& change, const vrml::Node& node);
  bool follow_viewer(const glm::dvec3& viewer);
  void follow_picture(const Screens& screens);
  bool follow_boxes();
  bool refine_texts();
  bool move_particles();
  void mark_frame(std::uint32_t frame, const glm::dmat4& parent_from_local);
  void move_frames();
  void place_item(std::uint32_t item);
  void place_splat(std::uint32_t splat);
  bool renew_geometry(std::uint32_t item);
  void apply_item_appearance(std::uint32_t item);
  bool renew_volume_item(std::uint32_t item);
  void renew_light(std::uint32_t light);
  void renew_scoped(const std::function<bool(const RenderSources::Local&)>& is_changed);
  void renew_viewpoint(std::uint32_t viewpoint);
  void renew_bindables();
  void set_background(const RenderSources::Local& local, const NodeView& view);
  void item_moved(std::uint32_t item);
  [[nodiscard]] const WideBox* bounds_of(std::size_t item) const;
  void sum_bounds();

  const vrml::SceneGraph& scene_;
  const Images& images_;
  const Geometries& geometries_;
  ShapeResources resources_;
  std::shared_ptr<RenderList> list_;
  RenderSources sources_;
  BoundNodes bound_;
  glm::dvec3 viewer_{0, 0, 10};
  Sight sight_;
  std::size_t gathered_ = 0;
  SceneLayers layers_;
  NodeUses uses_;
  std::vector<std::uint32_t> moved_frames_;
  std::vector<bool> frame_moved_;
  BlockBounds bounds_;  // of the items
  bool splat_moved_ = false;
  bool boxes_stale_ = false;    // items have moved after the boxes of bboxDisplay were made
  bool picture_moved_ = false;  // a Layout or the plane of a Viewport has moved with the viewer
  bool frame_lost_ = false;     // a coordinate system has overflowed, which hides its content
};

/// Reports changes of nodes to the cache. Call it once for all RenderScenes that share the cache.
void forget_changed(MeshCache& meshes, std::span<const vrml::NodeChange> changes);

}  // namespace gs::render
