#include "app/session/rays/world_rays.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr std::size_t kMaxTriangles = std::size_t{1} << 20;  // max triangles of the meshes on a ray

// Returns the indices of the items below a node.
std::vector<std::size_t> items_below(const render::RenderList& list, const vrml::NodePlace& node) {
  std::vector<bool> below(list.places.size());
  std::vector<std::size_t> items;
  // Parents precede their children in `places`.
  for (std::size_t i = 0; i < list.places.size(); ++i) {
    const render::Place& place = list.places[i];
    below[i] = (place.scene == node.scene && place.node == node.node) || (place.parent < i && below[place.parent]);
  }
  for (std::size_t i = 0; i < list.items.size(); ++i)
    if (list.items[i].place < below.size() && below[list.items[i].place]) items.push_back(i);
  return items;
}

}  // namespace

WorldRays::WorldRays(LoadedWorld& world, render::MeshCache& meshes, vrml::Execution& execution,
                     std::function<render::BoundNodes()> bound)
    : world_(world), meshes_(meshes), execution_(execution), bound_(std::move(bound)) {
  execution.browser().set_ray_caster([this](const glm::dvec3& from, const glm::dvec3& to,
                                            const vrml::NodePlace& below) { return cast(from, to, below); });
}

const render::RenderList& WorldRays::list() {
  const std::uint64_t stamp = execution_.cascade().stamp();
  if (scene_ && stamp_ == stamp) return scene_->list();
  stamp_ = stamp;
  if (!scene_) scene_.emplace(*world_.scene, world_.images, world_.geometries, meshes_);
  scene_->gather(bound_(), glm::dvec3(execution_.viewer().pose()[3]));
  return scene_->list();
}

std::optional<vrml::RayHit> WorldRays::cast(const glm::dvec3& from, const glm::dvec3& to,
                                            const vrml::NodePlace& below) {
  const double length = glm::length(to - from);
  if (!std::isfinite(length) || !(length > 0)) return std::nullopt;
  const render::RenderList& whole = list();
  const render::SightLine line{from, (to - from) / length, length};
  std::optional<render::RenderList> part;
  if (below.scene) part = only(whole, items_below(whole, below));
  const auto found =
      part ? items_below_.nearest(*part, line, kMaxTriangles) : items_.nearest(whole, line, kMaxTriangles);
  if (!found) return std::nullopt;
  Hit hit;
  hit.item = found->item;
  vrml::RayHit result{found->point, found->normal, found->texture_coordinate, {}};
  for (const vrml::PathStep& step : path_of(part ? *part : whole, hit)) result.path.emplace_back(step.scene, step.node);
  return result;
}

}  // namespace gs::app
