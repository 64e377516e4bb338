#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::displaced {

/// Where the error is looked at: cells of a grid of the box, one in so many.
class ErrorCells {
 public:
  ErrorCells(float side, std::size_t one_in) : per_side_(1 / std::max(side, 1e-6f)), one_in_(one_in) {}
  [[nodiscard]] bool has(const glm::vec3& p) const {
    const glm::uvec3 cell(glm::ivec3(glm::floor(p * per_side_)));
    const std::uint64_t number = (std::uint64_t{cell.x} << 42) ^ (std::uint64_t{cell.y} << 21) ^ cell.z;
    return (number * 0x9e3779b97f4a7c15u >> 32) % one_in_ == 0;
  }
  /// Whether a place is nearer to such a cell than so much, or somewhat farther; a side at most.
  [[nodiscard]] bool near(const glm::vec3& p, float reach) const {
    if (one_in_ == 1) return true;
    // Every cell within reach holds one of these.
    const int step = reach * per_side_ < 0.5f ? 2 : 1;
    for (int x = -1; x <= 1; x += step)
      for (int y = -1; y <= 1; y += step)
        for (int z = -1; z <= 1; z += step)
          if (has(p + reach * glm::vec3(x, y, z))) return true;
    return false;
  }

 private:
  float per_side_;
  std::size_t one_in_;
};

}  // namespace gs::qnv::displaced
