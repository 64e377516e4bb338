#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Adds the surface of an AVS UCD file (unstructured cell data; ascii, also the MicroAVS form with steps, of which
/// the first is read, and binary of both byte orders) to `scene` as one Shape with an IndexedFaceSet: triangles and
/// quadrilaterals, and those faces of tetrahedra, pyramids, prisms and hexahedra that belong to one cell only.
/// Lines and points are left out with a note. The first component of the data at nodes that is one number colours
/// the vertices, by viridis from the least to the greatest (see color_key.h); without data at nodes that of the cells
/// colours the faces. Of cells with nodes on their edges the corners are used. Safe for untrusted input;
/// memory is bounded by a multiple of the file; a text that ends early gives the cells that were there and an error.
/// Layout: AVS Developer's Guide; binary as in VTK's reader.
void import_ucd(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics);

}  // namespace gs::app
