#pragma once

#include "vrml/scene/scene_graph.h"

#include <vector>

namespace gs::vrml {

/// Returns the texture coordinate nodes of a geometry node, in the order of the sets of coordinates: the node in its
/// field `texCoord`, or the nodes of the MultiTextureCoordinate there. Empty if there are none.
[[nodiscard]] std::vector<NodeId> texture_coordinate_nodes(const SceneGraph& scene, NodeId geometry);

}  // namespace gs::vrml
