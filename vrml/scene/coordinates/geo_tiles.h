#pragma once

#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

/// Makes the Inline for rootUrl of a GeoLOD (X3D 25.3.4), unless the GeoLOD has one, or has no rootUrl. Returns true if
/// it was made.
bool make_root_tile(SceneGraph& scene, NodeId lod);
/// Makes the Inlines for child1Url to child4Url of a GeoLOD, unless the GeoLOD has them, or has no such urls. Returns
/// true if they were made.
bool make_child_tiles(SceneGraph& scene, NodeId lod);

}  // namespace gs::vrml
