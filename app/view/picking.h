#pragma once

#include "app/view/navigation.h"
#include "render/rays/item_bvh.h"
#include "render/scene/render_list.h"
#include "render/scene/splat_style.h"
#include "render/volume/volume_model.h"
#include "vrml/events/execution.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::app {

/// Point at which a ray hits the world.
struct Hit {
  float distance = 0;                // metres from the origin of the ray
  std::size_t item = 0;              // index in RenderList::items, if `splat` is nullopt
  std::optional<std::size_t> splat;  // index in RenderList::splats; nullopt if a triangle was hit
  // World space; see render::SurfaceHit. For a hit without a surface normal, `normal` points to the origin of the ray.
  glm::dvec3 point{0}, normal{0};
  glm::vec2 texture_coordinate{0};
  render::TriangleHit triangle;  // valid if `splat` is nullopt; see render::SurfaceHit
  /// Colour 0..1 of the vector or stream patch that was hit; nullopt if it has no own colour.
  std::optional<glm::vec3> stream_color{};
};

struct PickOptions {
  float pixel = 0.001f;                              // width of a pixel at distance 1
  render::SplatStyle splat_style;                    // style with which the splats are drawn
  std::size_t max_triangles = std::size_t{1} << 24;  // max triangles in the cache
  std::optional<render::SightLine> overlay_line{};   // line for overlays; nullopt: the same as for other items
  bool holds_overlay = false;                        // a sensor of an overlay has grabbed the pointer
};

/// Search for the object under the pointer. Use on the drawing thread. Caches search data for meshes and volumes as
/// long as these exist.
class Picker {
 public:
  /// Returns the nearest hit of a triangle or splat in `list` along `line`. In a volume, the hit is the point where the
  /// accumulated opacity reaches 0.5; a fainter volume is hit only if nothing else is. Triangles are hit from both
  /// sides, and splats as they are drawn (render/rays/splat_pick.h). Lines and points are not hit.
  ///
  /// Takes microseconds for triangles, and more for changed items and new meshes (render/rays/item_bvh.h). For splats
  /// without levels of detail, the time is proportional to their number: 30 ms for 5 million. `line.direction` must
  /// have unit length.
  [[nodiscard]] std::optional<Hit> pick(const render::RenderList& list, const render::SightLine& line,
                                        const PickOptions& options = {});
  [[nodiscard]] std::optional<Hit> pick(const render::RenderList& list, const Ray& ray,
                                        const PickOptions& options = {});
  /// Returns the cache of triangles, for other searches in the same lists.
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

/// Pointing-device sensor or Anchor, with the draw items that belong to it (VRML97 4.6.7.3).
struct SensorGeometry {
  vrml::NodePlace sensor;
  std::vector<std::size_t> items;  // indices in RenderList::items; never empty
};
/// Returns the enabled sensors and Anchors with draw items in `list`, in the order of their first items. Ignores
/// splats.
[[nodiscard]] std::vector<SensorGeometry> sensor_geometry(vrml::Execution& world, const render::RenderList& list);
/// Sensor geometry of the last list that was asked for. Computes the geometry again only after changes of the list's
/// structure or of the sensors.
class SensorGeometries {
 public:
  /// Returns sensor_geometry(). Valid until the next call.
  [[nodiscard]] const std::vector<SensorGeometry>& of(vrml::Execution& world, const render::RenderList& list);

 private:
  std::vector<SensorGeometry> known_;
  const vrml::Execution* world_ = nullptr;
  std::uint64_t generation_ = 0, revision_ = 0;  // of the list and of the world's Pointing
};
/// Returns a list of these items of `list`, with the places above them.
[[nodiscard]] render::RenderList only(const render::RenderList& list, const std::vector<std::size_t>& items);
/// Returns a line from `eye` that hits a triangle of the list, if possible in the middle of an item. Returns nullopt if
/// the list has only lines, points, and triangles that are edge-on to `eye`.
[[nodiscard]] std::optional<render::SightLine> line_that_meets(const render::RenderList& list, const glm::dvec3& eye);

/// Returns the path from the root of the world to the Shape that was hit; empty if limits omitted the path.
[[nodiscard]] std::vector<vrml::PathStep> path_of(const render::RenderList& list, const Hit& hit);

/// Returns the half-line through `pointer`, which is in pixels from the upper left of a viewport of `size` pixels. Like
/// ray_through(), but in double precision.
[[nodiscard]] render::SightLine sight_line(const Pose& pose, const glm::dvec2& pointer, const glm::dvec2& size);

/// Returns the half-line through `pointer` for overlays, which are drawn in perspective also if the pose has a parallel
/// projection. Returns nullopt for a pose in perspective.
[[nodiscard]] std::optional<render::SightLine> overlay_line(const Pose& pose, const glm::dvec2& pointer,
                                                            const glm::dvec2& size);

/// Passes the pointer's line and its button state to the sensors of a world, at the present timestamp (VRML97 4.6.7.3).
/// `list` must be updated to the present state of the world. Returns the hit.
std::optional<Hit> point(vrml::Execution& world, Picker& picker, const render::RenderList& list,
                         const render::SightLine& line, bool down, const PickOptions& options = {});

}  // namespace gs::app
