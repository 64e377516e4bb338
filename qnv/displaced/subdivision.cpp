#include "qnv/displaced/subdivision.h"

namespace gs::qnv::displaced {

std::vector<glm::vec3> slot_normals(const Patches& patches, const Patches& slots, int level,
                                    std::span<const glm::vec3> positions) {
  std::vector<glm::vec3> normals(slots.vertices_at(level), glm::vec3(0));
  const std::size_t n = std::size_t{1} << level;
  std::vector<std::uint32_t> grid, slot_grid;
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    const glm::vec3 cross =
        glm::cross(positions[grid[b]] - positions[grid[a]], positions[grid[c]] - positions[grid[a]]);
    normals[slot_grid[a]] += cross;
    normals[slot_grid[b]] += cross;
    normals[slot_grid[c]] += cross;
  };
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    patches.grid(p, level, grid);
    slots.grid(p, level, slot_grid);
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t row = row_start(j, n), above = row_start(j + 1, n);
      for (std::size_t i = 0; i + j < n; ++i) {
        add(row + i, row + i + 1, above + i);
        if (i + j + 1 < n) add(row + i + 1, above + i + 1, above + i);
      }
    }
  }
  for (glm::vec3& normal : normals) {
    const float length = glm::length(normal);
    normal = length > 0 ? normal / length : glm::vec3(0);
  }
  return normals;
}

}  // namespace gs::qnv::displaced
