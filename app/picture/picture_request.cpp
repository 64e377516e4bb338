#include "app/picture/picture_request.h"

#include <algorithm>
#include <cmath>

namespace gs::app {

std::optional<glm::ivec2> pixels_of(const PictureRequest& request) {
  constexpr double kInch = 25.4;  // mm

  if (!request.paper) return std::nullopt;
  const double dots = request.dots_per_inch > 0 ? request.dots_per_inch : kUsualDots;
  const glm::dvec2 size(std::round(request.paper->x / kInch * dots), std::round(request.paper->y / kInch * dots));
  if (!(std::min(size.x, size.y) >= 1 && std::max(size.x, size.y) <= kMaxPictureSide)) return std::nullopt;
  return glm::ivec2(static_cast<int>(size.x), static_cast<int>(size.y));
}

}  // namespace gs::app
