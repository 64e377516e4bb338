#include "vrml/mesh/mesh.h"

namespace gs::vrml {

std::uint64_t Mesh::cost() const {
  const auto bytes = [](const auto& array) {
    const std::uint64_t size = array.size() * sizeof(*array.data());
    return array.shared() ? size : 2 * size;
  };
  std::uint64_t sum = bytes(positions) + bytes(normals) + bytes(colors) + bytes(opacities) + bytes(fog_depths) +
                      bytes(texture_coordinates) + bytes(indices);
  for (const CoordinateSet& set : coordinate_sets) sum += bytes(set);
  return sum;
}

Mesh tessellate(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  const NodeId resolved = scene.resolve(geometry);
  if (!resolved) return {};
  const Tessellate make = scene.node(resolved).type->tessellator.tessellate;
  return make ? make(scene, resolved, options) : Mesh{};
}

}  // namespace gs::vrml
