#pragma once

#include "vrml/mesh/mesh.h"

#include <cstddef>
#include <memory>

namespace gs::vrml {

/// About how much work `tessellate` has with the node, without doing any of it: in elements of the lists of an
/// IndexedFaceSet, which take some 10 to 50 ns each. 0 for what is no geometry.
[[nodiscard]] std::size_t tessellation_cost(const SceneGraph& scene, NodeId geometry);

/// A geometry node with all that its mesh is made of, in a scene of its own, for a thread that does not own the scene
/// it is of. Arrays are shared until either side changes its own (docs/decisions/0003).
struct GeometryCopy {
  std::unique_ptr<SceneGraph> scene;  // draws from the budget of the world; null: there was no room
  NodeId geometry, refiner;           // of `scene`; see MeshOptions::refiner
};
[[nodiscard]] GeometryCopy copy_geometry(const SceneGraph& scene, NodeId geometry, NodeId refiner = {});

}  // namespace gs::vrml
