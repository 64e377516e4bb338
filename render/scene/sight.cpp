#include "render/scene/sight.h"

#include "render/scene/camera.h"

#include <algorithm>
#include <cmath>

namespace gs::render {

double pixel_length(const Sight& sight, double depth) {
  const double smaller = std::max(std::min(sight.pixels.x, sight.pixels.y), 1.0);
  if (sight.height > 0) return sight.height / smaller;
  return depth * 2 * std::tan(double{sight.field_of_view} / 2) / smaller;
}

float pixels_per_radian(const Sight& sight) {
  return pixels_per_radian(sight.field_of_view, static_cast<float>(std::max(sight.pixels.x, 1.0)),
                           static_cast<float>(std::max(sight.pixels.y, 1.0)));
}

double height_for(const glm::dvec2& extent, const glm::dvec2& pixels) {
  const glm::dvec2 size = pixels.x > 0 && pixels.y > 0 ? pixels : glm::dvec2(1);
  const double smaller = std::min(size.x, size.y);
  return std::max(extent.x * smaller / size.x, extent.y * smaller / size.y);
}

}  // namespace gs::render
