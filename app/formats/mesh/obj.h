#pragma once

#include "app/base/read_file.h"
#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Imports a Wavefront OBJ file into `scene`: faces, lines and points, one Shape per group (o, g) and material
/// (usemtl). `read_file` provides the material libraries (mtllib): Kd, Ks, Ke, Ns, d, Tr, map_Kd. Without it, a note
/// names each library. Colours after the coordinates of `v` become Color nodes. Curves, surfaces and smoothing groups
/// are ignored. Safe for untrusted input. An invalid line gives an error with its location, and its face is skipped.
void import_obj(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics,
                const ReadFile& read_file = {});

}  // namespace gs::app
