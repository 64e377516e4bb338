#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports a legacy VTK file (.vtk, versions 1 to 5.1, text or binary) into `scene`. Reads the vertices, lines,
/// polygons and strips of DATASET POLYDATA, or the visible faces of an UNSTRUCTURED_GRID (grid_cells.h). Rejects other
/// datasets with a message. The first point SCALARS become colours (poly_data.h); else a one-component field, else
/// vector lengths; else the same of cells. COLOR_SCALARS are colours; NORMALS are kept. Safe for untrusted input. A
/// truncated file gives an error and its complete part. Layout: "VTK File Formats", Simple Legacy Formats (VTK User's
/// Guide).
void import_vtk_legacy(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics);
/// Detects the format by the first line.
[[nodiscard]] bool is_vtk_legacy(std::span<const std::byte> bytes);

}  // namespace gs::app
