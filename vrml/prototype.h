#pragma once

#include "vrml/scene_graph.h"

namespace gs::vrml {

/// Gives a PROTO instance the nodes of its body: copies them into the instance's scene, hands the
/// instance's values to the fields that IS names (VRML97 4.8.2, 4.8.3), copies the body's ROUTEs, and
/// goes on with the instances inside. Does nothing for a node that is no PROTO instance, is part of a
/// PROTO's declaration or has content already. False when `limits.nodes` stopped it.
bool instantiate(SceneGraph& scene, NodeId instance);

}  // namespace gs::vrml
