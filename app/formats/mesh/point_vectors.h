#pragma once

#include "app/formats/splats/splats.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Points with normals as read from a file, for vectors of a surface. `areas` and `colors` may be empty.
struct PointVectors {
  const char* format = "";
  std::vector<glm::dvec3> positions;
  std::vector<glm::vec3> normals, colors;  // colours are 0..255
  std::vector<float> areas;
  std::size_t announced = 0;
  Share share;

  /// Charges memory for `count` more points. Returns a message if the budget is exceeded.
  [[nodiscard]] std::optional<std::string> draw(const WorldBudget& budget, std::uint64_t count) {
    constexpr std::uint64_t kBytes = 230;
    if (share.amount() == 0) share = Share(budget, Resource::vectors);
    if (share.grow(count * kBytes)) return std::nullopt;
    return std::string(format) + ": the points take " + budget->refusal(Resource::vectors);
  }
};

/// Converts points to vectors. Drops invalid points. If the file has no areas, estimates them (point_areas), and drops
/// points at the position of earlier ones.
[[nodiscard]] ImportedVectors vectors_of_points(const PointVectors& points);

}  // namespace gs::app
