#include "qnv/mesh/triangle_weights.h"

#include "base/finite.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gs::qnv {

void weigh_by_triangles(IndexedMesh& mesh, std::size_t start, std::size_t first) {
  mesh.weights.resize(mesh.positions.size(), std::numeric_limits<float>::min());
  for (std::size_t i = first; i + 2 < mesh.triangles.size(); i += 3) {
    const std::uint32_t* t = mesh.triangles.data() + i;
    const glm::vec3 a = mesh.positions[t[0]];
    const float third = glm::length(glm::cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)) / 6;
    if (finite(third))
      for (std::size_t k = 0; k < 3; ++k) mesh.weights[t[k]] += third;
  }
  for (std::size_t i = start; i < mesh.weights.size(); ++i)
    mesh.weights[i] = std::min(mesh.weights[i], std::numeric_limits<float>::max());
}

}  // namespace gs::qnv
