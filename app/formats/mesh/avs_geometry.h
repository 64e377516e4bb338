#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports an AVS text geometry file (MicroAVS MGF, `# Micro AVS Geom:`) into `scene`, one named Shape per primitive.
/// Disjoint polygons, polyhedra, polytris and meshes become IndexedFaceSets; disjoint lines and polylines become
/// IndexedLineSets. Spheres, circles, columns, revolutions and labels are skipped with a warning. Vertex normals and
/// colours are kept. Of several steps, only the first is read.
///
/// The format follows the MicroAVS manual (Cybernet). Binary AVS5 .geom files, an undocumented layout, give an error.
/// Safe for untrusted input. A truncated file gives an error and its complete part.
void import_avs_geometry(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics);

/// Reports whether the file starts with `# Micro AVS Geom:`.
[[nodiscard]] bool is_avs_geometry(std::span<const std::byte> bytes);

}  // namespace gs::app
