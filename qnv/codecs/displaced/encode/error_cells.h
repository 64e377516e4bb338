#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace gs::qnv::displaced {

/// Sample of the grid cells for measuring the error: one of every `one_in` cells.
class ErrorCells {
 public:
  ErrorCells(float side, std::size_t one_in) : per_side_(1 / std::max(side, 1e-6f)), one_in_(one_in) {}
  [[nodiscard]] bool has(const glm::vec3& p) const { return is_one(cell_of(p)); }
  /// Reports whether a sampled cell is within `reach` of the point `p`. `reach` is at most a cell's edge. May also
  /// return true for cells slightly farther away.
  [[nodiscard]] bool near(const glm::vec3& p, float reach) const {
    if (one_in_ == 1) return true;
    const glm::ivec3 lower = cell_of(p - reach), upper = cell_of(p + reach);
    glm::ivec3 cell;
    for (cell.x = lower.x; cell.x <= upper.x; ++cell.x)
      for (cell.y = lower.y; cell.y <= upper.y; ++cell.y)
        for (cell.z = lower.z; cell.z <= upper.z; ++cell.z)
          if (is_one(cell)) return true;
    return false;
  }

 private:
  [[nodiscard]] glm::ivec3 cell_of(const glm::vec3& p) const { return glm::ivec3(glm::floor(p * per_side_)); }
  [[nodiscard]] bool is_one(const glm::ivec3& at) const {
    const glm::uvec3 cell(at);
    const std::uint64_t number = (std::uint64_t{cell.x} << 42) ^ (std::uint64_t{cell.y} << 21) ^ cell.z;
    return (number * 0x9e3779b97f4a7c15u >> 32) % one_in_ == 0;
  }

  float per_side_;
  std::size_t one_in_;
};

}  // namespace gs::qnv::displaced
