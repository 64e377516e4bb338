#include "qnv/mesh/triangle_weights.h"

#include "base/finite.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gs::qnv {

void weigh_by_triangles(Cloud& cloud, std::size_t start, std::size_t first) {
  cloud.weights.resize(cloud.positions.size(), std::numeric_limits<float>::min());
  for (std::size_t i = first; i + 2 < cloud.triangles.size(); i += 3) {
    const std::uint32_t* t = cloud.triangles.data() + i;
    const glm::vec3 a = cloud.positions[t[0]];
    const float third = glm::length(glm::cross(cloud.positions[t[1]] - a, cloud.positions[t[2]] - a)) / 6;
    if (finite(third))
      for (std::size_t k = 0; k < 3; ++k) cloud.weights[t[k]] += third;
  }
  for (std::size_t i = start; i < cloud.weights.size(); ++i)
    cloud.weights[i] = std::min(cloud.weights[i], std::numeric_limits<float>::max());
}

}  // namespace gs::qnv
