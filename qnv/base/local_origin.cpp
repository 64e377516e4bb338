#include "qnv/base/description.h"

#include <cmath>

namespace gs::qnv {

// Threshold of the distance from 0, in half extents. At larger distances, differences of float32 coordinates are exact,
// and a position loses at least 5 of 24 bits.
constexpr double kFarOfExtents = 32;
constexpr double kFarOfOne = 1024;  // threshold for a single point, which has no extent; units of the source

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
