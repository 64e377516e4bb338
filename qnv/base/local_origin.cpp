#include "qnv/base/description.h"

#include <cmath>

namespace gs::qnv {

// Threshold in half extents. Beyond it, float32 coordinates have exact float32 differences, and a position far from 0
// loses at least 5 of 24 bits.
constexpr double kFarOfExtents = 32;
constexpr double kFarOfOne = 1024;  // threshold for a single point, which has no extent; units

glm::dvec3 local_origin(const WideBox& box) {
  glm::dvec3 origin(0);
  if (box.empty()) return origin;
  const glm::dvec3 half = (box.upper - box.lower) * 0.5;
  const double extent = std::max({half.x, half.y, half.z});
  for (int i = 0; i < 3; ++i) {
    const double middle = box.lower[i] + half[i];
    if (std::abs(middle) > (extent > 0 ? kFarOfExtents * extent : kFarOfOne) && std::isfinite(middle))
      origin[i] = static_cast<double>(static_cast<float>(middle));
  }
  return origin;
}

}  // namespace gs::qnv
