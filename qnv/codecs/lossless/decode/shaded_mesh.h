#pragma once

#include "qnv/base/cloud.h"
#include "qnv/codecs/lossless/exact_mesh.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Mesh for display: its vertices, duplicated at creases and texture seams, and its triangles.
struct ShadedVertices {
  std::vector<glm::vec3> positions, normals;
  std::vector<Rgb8> colors;                    // one per vertex, or empty
  std::vector<glm::vec2> texture_coordinates;  // one per vertex, or empty
  std::vector<std::uint32_t> triangles;

  /// Appends the mesh to a point set. `with_colors` appends colours; a mesh without colours uses the point set's
  /// colour.
  void append(Cloud& cloud, bool with_colors) const;
};
/// Returns a mesh for display. `normals` are those of corners 3 t + k; `box` is the stream's.
[[nodiscard]] ShadedVertices shaded_vertices(const exact::ExactMesh& mesh, std::span<const glm::vec3> normals,
                                             const Box& box);

}  // namespace gs::qnv
