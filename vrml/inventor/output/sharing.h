#pragma once

#include "vrml/scene/scene_graph.h"

namespace gs::vrml::inventor {

/// Shares equal nodes of a converted file, and removes Groups and Transforms without effect. The picture stays the
/// same.
///
/// Nodes with events, urls or state of their own are not shared, nor are nodes with different DEF names. Nodes that are
/// no longer used stay in the arena. Does nothing for texts that are read into a running world. Costs time and memory
/// proportional to the scene.
void share_equal_nodes(SceneGraph& scene);

}  // namespace gs::vrml::inventor
