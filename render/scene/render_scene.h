#pragma once

#include "render/scene/collector.h"
#include "render/scene/render_list.h"
#include "render/scene/shape_resources.h"
#include "vrml/events/execution.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace gs::render {

/// The RenderList of a world that lives, as one viewer sees it: gathered once, then kept in step with what changes, so
/// that an update costs what has changed. Moved Transforms and Billboards, lights, Viewpoints, colours, textures and
/// geometries are updated in their places; what appears or goes has the whole gathered again. The list stays where it
/// is. One thread, that of the scene; all that it is made from must outlive it.
class RenderScene {
 public:
  RenderScene(const vrml::SceneGraph& scene, const Images& images, const Clouds& clouds, MeshCache& meshes);

  /// Gathers everything.
  void gather(const BoundNodes& bound, const glm::dvec3& viewer);
  /// Takes in what nodes have changed since the last time, which the cache has been told (forget_changed), and where
  /// the viewer is, in world space. True when the list is another than before.
  bool update(std::span<const vrml::NodeChange> changes, const BoundNodes& bound, const glm::dvec3& viewer);

  /// How large the pictures are that the list is for, which Text is cut for: pixels of an angle in their middle.
  void set_pixels_per_radian(float pixels) { pixels_per_radian_ = pixels; }

  /// Which way is up for the viewer, in world space: for the next `gather` or `update`.
  void set_viewer_up(const glm::dvec3& up) { viewer_up_ = up; }

  [[nodiscard]] const RenderList& list() const { return *list_; }
  [[nodiscard]] std::shared_ptr<const RenderList> shared_list() const { return list_; }
  /// Whether some of the list depends on where the viewer is.
  [[nodiscard]] bool depends_on_viewer() const {
    return !sources_.lods.empty() || !sources_.billboards.empty() || !sources_.texts.empty();
  }
  /// How often everything was gathered.
  [[nodiscard]] std::size_t gathered() const { return gathered_; }

 private:
  /// A part of the list that is made from a node.
  struct Use {
    const vrml::Node* node;
    std::uint32_t index;
    friend bool operator<(const Use& a, const Use& b) {
      return a.node != b.node ? std::less<>()(a.node, b.node) : a.index < b.index;
    }
  };
  using Uses = std::vector<Use>;
  enum class Effect : std::uint8_t { none, frame, dress, geometry, light, viewpoint, bindable, everything };

  [[nodiscard]] Effect effect_of(const vrml::NodeChange& change, const vrml::Node& node);
  [[nodiscard]] static std::span<const Use> uses_of(const Uses& uses, const vrml::Node* node);
  const Uses& frame_uses();
  const Uses& item_uses();
  bool follow_viewer(const glm::dvec3& viewer);
  bool refine_texts();
  void mark_frame(std::uint32_t frame, const glm::dmat4& parent_from_local);
  void move_frames();
  void place_item(std::uint32_t item);
  void place_splat(std::uint32_t splat);
  bool renew_geometry(std::uint32_t item);
  void dress_item(std::uint32_t item);
  void renew_light(std::uint32_t light);
  void renew_viewpoint(std::uint32_t viewpoint);
  void renew_bindables();
  void begin_generation();
  void item_moved(std::uint32_t item);
  [[nodiscard]] bool fills_bounds(std::size_t item) const;
  void sum_bounds();

  const vrml::SceneGraph& scene_;
  const Images& images_;
  const Clouds& clouds_;
  ShapeResources resources_;
  std::shared_ptr<RenderList> list_;
  RenderSources sources_;
  BoundNodes bound_;
  glm::dvec3 viewer_{0, 0, 10};
  glm::dvec3 viewer_up_{0, 1, 0};
  float pixels_per_radian_ = kUsualPixelsPerRadian;
  std::size_t gathered_ = 0;
  Uses frame_uses_, item_uses_;  // sorted; made when they are first asked for
  bool frame_uses_known_ = false, item_uses_known_ = false;
  std::vector<std::uint32_t> moved_frames_;
  std::vector<bool> frame_moved_;
  std::vector<WorldBounds> block_bounds_;  // of kBoundsBlock items each
  std::vector<std::uint32_t> stale_blocks_;
  std::vector<bool> block_stale_;
  bool splat_moved_ = false;
  bool frame_lost_ = false;  // its numbers have become too large, which hides what is below it
};

/// Tells the cache what has changed, once for all scenes that share it.
void forget_changed(MeshCache& meshes, std::span<const vrml::NodeChange> changes);

}  // namespace gs::render
