#pragma once

#include "app/view/navigation.h"
#include "render/rays/item_bvh.h"
#include "render/scene/cloud_look.h"
#include "render/scene/render_list.h"
#include "render/volume/volume_model.h"
#include "vrml/events/execution.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Intersection of a ray with the world.
struct Hit {
  float distance = 0;                // metres from the ray's origin
  std::size_t item = 0;              // index into RenderList::items, if `splat` is empty
  std::optional<std::size_t> splat;  // index into RenderList::splats
  // World space; see render::SurfaceHit. Without a surface normal, `normal` points towards the ray's origin.
  glm::dvec3 point{0}, normal{0};
  glm::vec2 texture_coordinate{0};
  render::TriangleHit triangle;  // valid if `splat` is empty; see render::SurfaceHit
  /// Own colour of the vector or stream patch that was hit, 0..1; empty if it has none.
  std::optional<glm::vec3> stream_color{};
};

struct PickOptions {
  float pixel = 0.001f;                              // width of a pixel at distance 1
  render::SplatStyle clouds;                         // must match the drawn style
  std::size_t max_triangles = std::size_t{1} << 24;  // max triangles to cache
};

/// Finds the object under the pointer. Belongs to the thread that draws. Caches costly data for meshes and volumes as
/// long as their owners exist.
class Picker {
 public:
  /// Returns the nearest triangle or splat of `list` along `line`, or the point in a volume where opacity reaches 0.5.
  /// Triangles count from both sides, splats as they are drawn (render/rays/splat_pick.h). Lines and points are not
  /// hit. A fainter volume is hit only if nothing else is.
  ///
  /// Takes microseconds for triangles, more for changed items and new meshes (render/rays/item_bvh.h). Splats without
  /// levels take time proportional to their number (5 M: 30 ms). `line.direction` has unit length.
  [[nodiscard]] std::optional<Hit> pick(const render::RenderList& list, const render::SightLine& line,
                                        const PickOptions& options = {});
  [[nodiscard]] std::optional<Hit> pick(const render::RenderList& list, const Ray& ray,
                                        const PickOptions& options = {});
  /// Returns the triangle cache, for other queries on the same lists.
  [[nodiscard]] render::ItemBvh& items() { return items_; }

 private:
  struct Held {
    std::weak_ptr<const qnv::Volume> volume;
    render::VolumeModel model;
  };
  const render::VolumeModel& model_of(const std::shared_ptr<const qnv::Volume>& volume);
  render::ItemBvh items_;
  std::unordered_map<const qnv::Volume*, Held> models_;
};

/// Pointing-device sensor or Anchor, with its geometry in a list (VRML97 4.6.7.3).
struct SensorGeometry {
  vrml::NodePlace sensor;
  std::vector<std::size_t> items;  // indices into RenderList::items; never empty
};
/// Returns the enabled sensors that `list` shows, in the order of their first items. Ignores splats.
[[nodiscard]] std::vector<SensorGeometry> sensor_geometry(vrml::Execution& world, const render::RenderList& list);
/// Returns a copy of `list` with only these items.
[[nodiscard]] render::RenderList only(const render::RenderList& list, const std::vector<std::size_t>& items);
/// Returns a line from `eye` that hits a triangle of the list, near the middle of an item if possible. Returns nullopt
/// if there are only lines, points and triangles seen edge-on.
[[nodiscard]] std::optional<render::SightLine> line_that_meets(const render::RenderList& list, const glm::dvec3& eye);

/// Returns the path from the root of the world to the hit Shape. Returns an empty path if limits omitted it.
[[nodiscard]] std::vector<vrml::PathStep> path_of(const render::RenderList& list, const Hit& hit);

/// Returns the half line through `pointer`, in pixels from the upper left of a viewport of `size` pixels; see
/// ray_through.
[[nodiscard]] render::SightLine sight_line(const Pose& pose, const glm::dvec2& pointer, const glm::dvec2& size);

/// Updates the world's sensors with the pointer's line and button state, at the present timestamp (VRML97 4.6.7.3).
/// `list` must match the present world.
std::optional<Hit> point(vrml::Execution& world, Picker& picker, const render::RenderList& list,
                         const render::SightLine& line, bool down, const PickOptions& options = {});

}  // namespace gs::app
