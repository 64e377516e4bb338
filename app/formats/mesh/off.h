#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports the polygons of a text OFF file (Geomview's Object File Format) into `scene` as one Shape with an
/// IndexedFaceSet. Supports [ST][C][N]OFF: texture coordinates, colours and normals of corners. Face colours follow the
/// indices: three or four numbers, integers 0 to 255 or decimals 0 to 1; the fourth is ignored. Rejects 4OFF, nOFF and
/// binary files with a message. Safe for untrusted input. A truncated file gives an error and its complete faces.
void import_off(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics);
/// Detects OFF by its first word.
[[nodiscard]] bool is_off(std::span<const std::byte> bytes);

}  // namespace gs::app
