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

/// Returns all triangles of a list in world space, with corners merged by position.
[[nodiscard]] Mesh welded(const render::RenderList& list);
/// Writes positions with nine digits, which keep every float. Returns false on failure.
[[nodiscard]] bool write_obj(const Mesh& mesh, const std::string& path);
/// Returns one VRML97 IndexedFaceSet with this creaseAngle and six digits per number.
[[nodiscard]] std::string vrml_text(const Mesh& mesh, float crease_angle = 3.14f);
/// Compresses like `gzip -9`, without a name.
[[nodiscard]] std::string gzipped(const std::string& text);
/// Encodes MESH.obj as MESH.drc and decodes that to MESH.out.obj, with draco_encoder and draco_decoder at level 10.
/// Returns false if the programs are missing or fail. `base` is the path without extension.
[[nodiscard]] bool make_draco(const std::string& base, int bits);

}  // namespace gs::bench
