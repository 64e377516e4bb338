#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Adds the vertices, lines, polygons and strips of a legacy VTK file (.vtk, versions 1 to 5.1, text or binary) with
/// DATASET POLYDATA to `scene`, or what is seen from outside of the cells of an UNSTRUCTURED_GRID (grid_cells.h);
/// other datasets are refused by name. Its first SCALARS of points (else a field of one
/// number, else the lengths of vectors; else the same of cells) become colours as poly_data.h says; COLOR_SCALARS are
/// colours themselves, NORMALS are kept. Safe for untrusted input; a file that ends early gives what was there and an
/// error. Layout: "VTK File Formats", Simple Legacy Formats (VTK User's Guide).
void import_vtk_legacy(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics);
/// By its first line.
[[nodiscard]] bool is_vtk_legacy(std::span<const std::byte> bytes);

}  // namespace gs::app
