#pragma once

#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Adds the geometry of an AVS text geometry file (MicroAVS MGF, `# Micro AVS Geom:`) to `scene`, a Shape for each
/// primitive, under its name: disjoint polygon, polyhedron, polytri and mesh become IndexedFaceSets, disjoint line
/// and polyline IndexedLineSets; spheres, circles, columns, revolutions and labels are left out with a warning. Normals
/// and colours of vertices come along. Of a file with steps the first one is read. The format is that of the MicroAVS
/// manual (Cybernet). AVS5's binary .geom files, whose layout is that of a closed library, give an error.
/// Safe for untrusted input; a file that ends early gives what was there and an error.
void import_avs_geometry(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics);

/// True for `# Micro AVS Geom:` at the start.
[[nodiscard]] bool is_avs_geometry(std::span<const std::byte> bytes);

}  // namespace gs::app
