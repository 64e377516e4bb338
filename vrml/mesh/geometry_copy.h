#pragma once

#include "vrml/mesh/mesh.h"

#include <cstddef>
#include <memory>

namespace gs::vrml {

/// Estimates the work of `tessellate` for the node. The unit is the work for one list element of an IndexedFaceSet, 10
/// to 50 ns. Returns 0 if the node is not a geometry.
[[nodiscard]] std::size_t tessellation_cost(const SceneGraph& scene, NodeId geometry);

/// Copy of a geometry node, and of everything that its mesh depends on, in a separate scene. It serves threads that do
/// not own the original scene. Arrays are shared copy-on-write (docs/decisions/0003).
struct GeometryCopy {
  std::unique_ptr<SceneGraph> scene;  // charges the world's budget; null if the budget is exhausted
  NodeId geometry, refiner;  // nodes in `scene`; see MeshOptions::refiner
};
[[nodiscard]] GeometryCopy copy_geometry(const SceneGraph& scene, NodeId geometry, NodeId refiner = {});

}  // namespace gs::vrml
