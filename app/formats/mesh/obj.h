#pragma once

#include "app/base/read_file.h"
#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Adds the faces, lines and points of a Wavefront OBJ file to `scene`: one Shape for each group (o, g) and
/// material (usemtl). Materials come from the libraries (mtllib) that `read_file` gives: Kd, Ks, Ke, Ns, d, Tr,
/// map_Kd; without it each library is named in a note. Colours behind the coordinates of `v` become Color
/// nodes. Curves, surfaces and smoothing between groups are skipped. Safe for untrusted input; a broken line
/// gives an error with its place, and its face is left out.
void import_obj(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics,
                const ReadFile& read_file = {});

/// The names of the material libraries of an OBJ file, each once, in the order of the file.
[[nodiscard]] std::vector<std::string> obj_material_libraries(std::span<const std::byte> bytes);

}  // namespace gs::app
