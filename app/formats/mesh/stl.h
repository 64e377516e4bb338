#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports the triangles of a binary or text STL file into `scene` as one Shape with an IndexedFaceSet. Merges equal
/// corners; uses creaseAngle 0 (flat shading, as CAD parts need) instead of normals. Attribute bytes with colours
/// become face colours: the VisCAM and SolidView form (bit 15 set on every facet), or Materialise Magics (COLOR= in the
/// header). Binary files are detected by size, because their header may begin with "solid". Safe for untrusted input. A
/// truncated file gives an error and its complete facets.
void import_stl(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics);

}  // namespace gs::app
