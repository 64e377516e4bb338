#pragma once

#include "render/scene/render_list.h"

#include <optional>
#include <string>
#include <vector>

namespace gs::bench {

/// Triangles with shared corners.
struct Mesh {
  std::vector<float> positions;  // x y z
  std::vector<unsigned> indices;
};

/// All triangles of a list, world space; corners at the same place become one.
[[nodiscard]] Mesh welded(const render::RenderList& list);
/// False when it could not be written. Positions with nine digits: every float as it is.
[[nodiscard]] bool write_obj(const Mesh& mesh, const std::string& path);
/// One IndexedFaceSet with this creaseAngle, VRML97, with six digits a number.
[[nodiscard]] std::string vrml_text(const Mesh& mesh, float crease_angle = 3.14f);
/// As `gzip -9` makes it, without a name.
[[nodiscard]] std::string gzipped(const std::string& text);
/// Encodes MESH.obj as MESH.drc and that back as MESH.out.obj, by the programs draco_encoder and draco_decoder; a level
/// of 10. False where they are missing or fail. `base`: the path without its ending.
[[nodiscard]] bool make_draco(const std::string& base, int bits);

}  // namespace gs::bench
