#pragma once

#include "vrml/mesh/mesh.h"

#include <cstddef>
#include <memory>

namespace gs::vrml {

/// Estimates the work of `tessellate` for the node, in elements of the lists of an IndexedFaceSet (10 to 50 ns each).
/// Returns 0 if the node is no geometry.
[[nodiscard]] std::size_t tessellation_cost(const SceneGraph& scene, NodeId geometry);

/// Copy of a geometry node and everything its mesh depends on, in its own scene. For a thread that does not own the
/// original scene. Arrays are shared copy-on-write (docs/decisions/0003).
struct GeometryCopy {
  std::unique_ptr<SceneGraph> scene;  // draws from the world's budget; null if that is exhausted
  NodeId geometry, refiner;           // in `scene`; see MeshOptions::refiner
};
[[nodiscard]] GeometryCopy copy_geometry(const SceneGraph& scene, NodeId geometry, NodeId refiner = {});

}  // namespace gs::vrml
