#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Adds the triangles of an STL file, binary or text, to `scene` as one Shape with an IndexedFaceSet: equal
/// corners become one point, normals are left to creaseAngle 0 (flat, as CAD parts are meant). Colours in the
/// attribute bytes become face colours, in the form of VisCAM and SolidView (bit 15 set on every facet) or of
/// Materialise Magics (COLOR= in the header). A binary file is known by its size, so its header may begin with
/// "solid". Safe for untrusted input; a file that ends early gives the facets that were there and an error.
void import_stl(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics);

}  // namespace gs::app
