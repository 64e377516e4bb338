#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports the surface of an AVS UCD file (unstructured cell data) into `scene` as one Shape with an IndexedFaceSet.
/// Reads ASCII, including the first step of the MicroAVS form, and binary of both byte orders. The surface consists of
/// triangles, quadrilaterals, and the faces of tetrahedra, pyramids, prisms and hexahedra that only one cell has. Lines
/// and points are skipped with a note. Of cells with nodes on edges, only the corners are used.
///
/// The first scalar component of node data colours the vertices, with Viridis from minimum to maximum (see
/// color_key.h). Without node data, cell data colour the faces.
///
/// Safe for untrusted input; memory is bounded by a multiple of the file size. A truncated text gives an error and its
/// complete cells. Layout: AVS Developer's Guide; binary as in VTK's reader.
void import_ucd(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics);

}  // namespace gs::app
