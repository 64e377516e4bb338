#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports the mesh or points of a PLY file (Turk 1994: ascii, binary_little_endian, binary_big_endian) into `scene` as
/// one Shape. The geometry is an IndexedFaceSet from `face` or `tristrips` elements, else an IndexedLineSet from `edge`
/// elements, else a PointSet. Keeps normals, texture coordinates, and colours of vertices or faces (including the
/// constant term of 3D Gaussian splats). Ignores other elements and properties. Colours are display colours;
/// coordinates are unchanged. Safe for untrusted input; memory is bounded by a small multiple of the file size. A
/// truncated file gives an error and its complete part.
void import_ply(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics);

}  // namespace gs::app
