#pragma once

#include "qnv/base/cloud.h"
#include "qnv/exact/exact_mesh.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace gs::qnv {

/// A mesh on a lattice as it is shown: its vertices, one a side where it has a crease, and the triangles between them.
struct ShadedVertices {
  std::vector<glm::vec3> positions, normals;
  std::vector<Rgb8> colors;  // one a vertex, or none at all
  std::vector<std::uint32_t> triangles;

  /// `with_colors`: the cloud has colours, its own where these have none.
  void append(Cloud& cloud, bool with_colors) const;
};
/// `box`: of the stream.
[[nodiscard]] ShadedVertices shaded_vertices(const exact::ExactMesh& mesh, const exact::Shading& shading,
                                             const Box& box);

}  // namespace gs::qnv
