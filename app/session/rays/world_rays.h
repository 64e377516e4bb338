#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/view/picking.h"
#include "render/collection/render_scene.h"
#include "vrml/events/execution.h"

#include <cstdint>
#include <functional>
#include <optional>

namespace gs::app {

/// Rays that the Scripts of a world cast (Browser.computeRayHit). Collects the world at most once per timestamp. Finds
/// triangles only, no splats. Use on the world's thread.
class WorldRays {
 public:
  /// `bound` returns the bound nodes of the world.
  WorldRays(LoadedWorld& world, render::MeshCache& meshes, vrml::Execution& execution,
            std::function<render::BoundNodes()> bound);
  WorldRays(const WorldRays&) = delete;
  WorldRays& operator=(const WorldRays&) = delete;

  /// Discards the collected world. Call before nodes are removed.
  void forget() { scene_.reset(); }

 private:
  [[nodiscard]] std::optional<vrml::RayHit> cast(const glm::dvec3& from, const glm::dvec3& to,
                                                 const vrml::NodePlace& below);
  [[nodiscard]] const render::RenderList& list();

  LoadedWorld& world_;
  render::MeshCache& meshes_;
  vrml::Execution& execution_;
  std::function<render::BoundNodes()> bound_;
  std::optional<render::RenderScene> scene_;
  std::uint64_t stamp_ = 0;  // serial number of the timestamp at which the world was collected
  render::ItemBvh items_, items_below_;
};

}  // namespace gs::app
