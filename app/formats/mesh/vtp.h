#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Adds the vertices, lines, polygons and strips of all pieces of a VTK XML PolyData file to `scene`: text, base64 or
/// appended data, packed by zlib or not. Its active scalars (else the first array of one number a point; else those of
/// cells) become colours as poly_data.h says; of vectors their lengths; bytes in threes and fours are colours
/// themselves. Active normals are kept. Safe for untrusted input; of a piece of which an array is wrong or missing the
/// rest is shown, with an error. Layout: https://docs.vtk.org/en/latest/vtk_file_formats/vtkxml_file_format.html
void import_vtp(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics);
/// By its root element.
[[nodiscard]] bool is_vtp(std::span<const std::byte> bytes);

/// The same of a VTK XML UnstructuredGrid: what is seen of its cells from outside (grid_cells.h).
void import_vtu(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics);
[[nodiscard]] bool is_vtu(std::span<const std::byte> bytes);

}  // namespace gs::app
