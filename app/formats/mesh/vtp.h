#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports all pieces of a VTK XML PolyData file into `scene`: vertices, lines, polygons and strips. Data may be text,
/// base64 or appended, with or without zlib. The active scalars become colours (poly_data.h); else the first
/// one-component point array; else those of cells. Vectors count by length; bytes in threes and fours are colours.
/// Active normals are kept. Safe for untrusted input. If an array of a piece is invalid or missing, the rest is shown
/// with an error. Layout: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
void import_vtp(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics);
/// Detects the format by the root element.
[[nodiscard]] bool is_vtp(std::span<const std::byte> bytes);

/// Imports the visible cell faces of a VTK XML UnstructuredGrid (grid_cells.h); otherwise like import_vtp.
void import_vtu(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics);
[[nodiscard]] bool is_vtu(std::span<const std::byte> bytes);

}  // namespace gs::app
