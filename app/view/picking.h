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

/// Where a ray meets the world.
struct Hit {
  float distance = 0;                // metres from the ray's origin
  std::size_t item = 0;              // of RenderList::items, where `splat` is empty
  std::optional<std::size_t> splat;  // of RenderList::splats
  // World space; see render::SurfaceHit. The normal of what has none is towards where the ray comes from.
  glm::dvec3 point{0}, normal{0};
  glm::vec2 texture_coordinate{0};
  render::TriangleHit triangle;  // where `splat` is empty; see render::SurfaceHit
  /// 0..1, of the vector, or of the patch of a stream, where those have colours of their own.
  std::optional<glm::vec3> stream_color{};
};

struct PickOptions {
  float pixel = 0.001f;                              // how wide a pixel of the picture is at distance 1
  render::CloudLook clouds;                          // as they are drawn
  std::size_t max_triangles = std::size_t{1} << 24;  // that are remembered
};

/// Finds what lies under the pointer. Belongs to the thread that draws; remembers of meshes and volumes what takes long
/// to find out, as long as somebody else holds them.
class Picker {
 public:
  /// The nearest triangle or disc of `list` that `line` meets, or place of a volume where half of the light is taken.
  /// Triangles count from both sides, discs as they are drawn (render/rays/splat_pick.h). Lines and points are too
  /// thin to hit. A volume that is fainter than that along the ray is hit only where nothing else is.
  ///
  /// Takes some microseconds for the triangles, and more for items that have changed and meshes that are new
  /// (render/rays/item_bvh.h), and time in proportion to the vectors of all clouds without levels (5 M: 30 ms).
  /// `line.direction` is of unit length.
  [[nodiscard]] std::optional<Hit> pick(const render::RenderList& list, const render::SightLine& line,
                                        const PickOptions& options = {});
  [[nodiscard]] std::optional<Hit> pick(const render::RenderList& list, const Ray& ray,
                                        const PickOptions& options = {});
  /// What it keeps of the triangles, for others who ask for the same lists.
  [[nodiscard]] render::ItemBvh& items() { return items_; }

 private:
  struct Held {
    std::weak_ptr<const qnv::Cloud> cloud;
    render::VolumeModel model;
  };
  const render::VolumeModel& model_of(const std::shared_ptr<const qnv::Cloud>& cloud);
  render::ItemBvh items_;
  std::unordered_map<const qnv::Cloud*, Held> models_;
};

/// A pointing-device sensor, or an Anchor, and what of a list is its geometry (VRML97 4.6.7.3).
struct SensorGeometry {
  vrml::NodePlace sensor;
  std::vector<std::size_t> items;  // of RenderList::items, at least one
};
/// The enabled ones of what `list` shows, in the order in which their first items stand there. Vectors do not count.
[[nodiscard]] std::vector<SensorGeometry> sensor_geometry(vrml::Execution& world, const render::RenderList& list);
/// `list` with these items alone.
[[nodiscard]] render::RenderList only(const render::RenderList& list, const std::vector<std::size_t>& items);
/// A line from `eye` that meets a triangle of the list: near the middle of an item, if it does there. Nothing where
/// there are none but lines, points and triangles that are seen from their edges.
[[nodiscard]] std::optional<render::SightLine> line_that_meets(const render::RenderList& list, const glm::dvec3& eye);

/// Picks once, remembering nothing.
[[nodiscard]] std::optional<Hit> pick(const render::RenderList& list, const Ray& ray, const PickOptions& options = {});

/// The way from the root of the world to the Shape that was hit. Empty where limits left it out.
[[nodiscard]] std::vector<vrml::PathStep> path_of(const render::RenderList& list, const Hit& hit);

/// The half line through `pointer`, in pixels from the upper left of a viewport of `size` pixels; see ray_through.
[[nodiscard]] render::SightLine sight_line(const Pose& pose, const glm::dvec2& pointer, const glm::dvec2& size);

/// Tells the sensors of the world what the pointing device points at along `line`, and whether its button is down, at
/// the present timestamp (VRML97 4.6.7.3). `list` shows the world as it is.
std::optional<Hit> point(vrml::Execution& world, Picker& picker, const render::RenderList& list,
                         const render::SightLine& line, bool down, const PickOptions& options = {});

}  // namespace gs::app
