#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Adds the mesh or point cloud of a PLY file (Turk 1994: ascii, binary_little_endian, binary_big_endian)
/// to `scene` as one Shape: an IndexedFaceSet of its `face` or `tristrips` elements, else an IndexedLineSet of
/// its `edge` elements, else a PointSet. Normals, colours (of vertices or faces, the constant term of 3D
/// Gaussian splats too) and texture coordinates come along; other elements and properties are skipped.
/// Safe for untrusted input; memory is bounded by a small multiple of the file. A file that ends early gives
/// what was there and an error. Colours are taken as display colours, coordinates as they are.
void import_ply(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics);

}  // namespace gs::app
