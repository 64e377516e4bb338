#include "render/collection/collector.h"

#include <cmath>

namespace gs::render {

RenderList collect(const vrml::SceneGraph& scene, const Images& images, MeshCache& meshes, const glm::dvec3& viewer,
                   const Geometries& geometries, const BoundNodes* bound, float pixels_per_radian) {
  const bool usable = std::isfinite(viewer.x) && std::isfinite(viewer.y) && std::isfinite(viewer.z);
  ShapeResources resources(images, meshes, scene.budget());
  return Collector(resources, usable ? viewer : glm::dvec3(0, 0, 10), geometries, bound, scene.budget(), nullptr,
                   pixels_per_radian)
      .collect(scene);
}

}  // namespace gs::render
