#pragma once

#include <glm/vec3.hpp>

#include <algorithm>
#include <cstdint>

namespace gs::qnv::displaced {

/// Triangle and the centre by which spatial partitioning sorts it.
struct Centre {
  glm::vec3 place;
  std::uint32_t triangle;
};

/// Partitions triangles: those with the lower centres along an axis precede `middle`. No two entries compare equal. The
/// comparison is branch-free, because its result is unpredictable.
template <class At>
void put_middle(At begin, At middle, At end, int axis) {
  const auto along = [&](auto coordinate) {
    std::nth_element(begin, middle, end, [coordinate](const Centre& a, const Centre& b) {
      const float at = a.place.*coordinate, other = b.place.*coordinate;
      return (static_cast<unsigned>(at < other) |
              (static_cast<unsigned>(at == other) & static_cast<unsigned>(a.triangle < b.triangle))) != 0;
    });
  };
  if (axis == 0) return along(&glm::vec3::x);
  if (axis == 1) return along(&glm::vec3::y);
  along(&glm::vec3::z);
}

}  // namespace gs::qnv::displaced
