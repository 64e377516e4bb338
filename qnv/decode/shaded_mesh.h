#pragma once

#include "qnv/base/cloud.h"
#include "qnv/exact/exact_mesh.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// A mesh on a lattice as it is shown: its vertices, one a side where it has a crease or its texture a seam, and the
/// triangles between them.
struct ShadedVertices {
  std::vector<glm::vec3> positions, normals;
  std::vector<Rgb8> colors;                    // one a vertex, or none at all
  std::vector<glm::vec2> texture_coordinates;  // likewise
  std::vector<std::uint32_t> triangles;

  /// `with_colors`: the cloud has colours, its own where these have none.
  void append(Cloud& cloud, bool with_colors) const;
};
/// `normals`: of corners 3 t + k; `box`: of the stream.
[[nodiscard]] ShadedVertices shaded_vertices(const exact::ExactMesh& mesh, std::span<const glm::vec3> normals,
                                             const Box& box);

}  // namespace gs::qnv
