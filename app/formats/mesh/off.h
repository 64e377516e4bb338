#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Adds the polygons of a text file of the Object File Format (Geomview's OFF) to `scene` as one Shape with an
/// IndexedFaceSet: [ST][C][N]OFF, so with texture coordinates, colours and normals of the corners, and colours of faces
/// behind their indices (three or four numbers, whole from 0 to 255 or with a point from 0 to 1; the fourth is not
/// used). Files of four dimensions (4OFF, nOFF) and binary ones are refused by name. Safe for untrusted input; a file
/// that ends early gives the faces that were there and an error.
void import_off(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics);
/// By its first word.
[[nodiscard]] bool is_off(std::span<const std::byte> bytes);

}  // namespace gs::app
