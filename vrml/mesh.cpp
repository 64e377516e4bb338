#include "vrml/mesh.h"

namespace gs::vrml {

Mesh tessellate(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const NodeId resolved = scene.resolve(geometry);
  if (!resolved) return {};
  const Tessellate make = scene.node(resolved).type->tessellate;
  return make ? make(scene, resolved, options) : Mesh{};
}

}  // namespace gs::vrml
