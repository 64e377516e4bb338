#pragma once

#include "render/collection/collector.h"
#include "vrml/events/change_list.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace gs::render {

class RenderScene;

/// Drawn layers of a world besides the active one (X3D clause 35). Each has a RenderScene for the viewer at its
/// Viewpoint.
class SceneLayers {
 public:
  SceneLayers(const vrml::SceneGraph& scene, const Images& images, const Geometries& geometries, MeshCache& meshes);
  SceneLayers(SceneLayers&& other) noexcept;
  ~SceneLayers();

  /// Collects the layers of `bound`, and lists them.
  void gather(const BoundNodes& bound, const Sight& sight, std::vector<RenderLayer>& listed);
  /// Applies changes. Returns true if a layer has changed.
  bool update(std::span<const vrml::NodeChange> changes, const BoundNodes& bound, const Sight& sight,
              std::vector<RenderLayer>& listed);

 private:
  [[nodiscard]] bool show(std::size_t index, std::span<const vrml::NodeChange> changes, const BoundNodes& bound,
                          const Sight& sight, RenderLayer& layer);

  const vrml::SceneGraph& scene_;
  const Images& images_;
  const Geometries& geometries_;
  MeshCache& meshes_;
  std::vector<std::unique_ptr<RenderScene>> layers_;  // of BoundNodes::others
};

}  // namespace gs::render
