#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/lossless/exact_mesh.h"

#include <glm/vec3.hpp>

#include <span>

namespace gs::qnv {

/// Returns a mesh for display, without weights: its vertices are duplicated at creases and texture seams.
/// `normals[3 t + k]` is the normal of corner k of triangle t. `box` is the box of the stream.
[[nodiscard]] IndexedMesh shaded_mesh(const exact::ExactMesh& mesh, std::span<const glm::vec3> normals, const Box& box);

/// Appends `part` to `mesh`, with weights. `with_colors` appends colours; a part without colours uses the colour of
/// `mesh`.
void append_mesh(const IndexedMesh& part, IndexedMesh& mesh, bool with_colors);

}  // namespace gs::qnv
