#pragma once

#include "qnv/codecs/displaced/patches.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Vectors stored as three arrays, one per coordinate. Each array has padding at its end that loops may read and write.
class Columns {
 public:
  static constexpr std::size_t kRoom = 16;

  /// Resizes the arrays; their content becomes undefined.
  void resize(std::size_t count) {
    stride_ = count + kRoom;
    if (numbers_.size() < 3 * stride_) numbers_.resize(3 * stride_);
  }
  [[nodiscard]] float* operator[](std::size_t axis) { return numbers_.data() + axis * stride_; }
  [[nodiscard]] const float* operator[](std::size_t axis) const { return numbers_.data() + axis * stride_; }
  void put(std::size_t i, const glm::vec3& v) {
    float* const to = numbers_.data() + i;
    to[0] = v.x;
    to[stride_] = v.y;
    to[2 * stride_] = v.z;
  }
  [[nodiscard]] glm::vec3 at(std::size_t i) const {
    const float* const from = numbers_.data() + i;
    return {from[0], from[stride_], from[2 * stride_]};
  }

 private:
  std::vector<float> numbers_;
  std::size_t stride_ = 0;
};

/// Calls put(i, v) for every vertex of a patch at a level. `v` is the vertex index in Patches, `i` its index in the
/// order of Patches::grid().
template <class Put>
void for_each_of_grid(const displaced::Patches& patches, std::uint32_t patch, int level, const Put& put) {
  using displaced::row_start;
  const std::size_t n = std::size_t{1} << level;
  const displaced::Corners& corners = patches.triangles()[patch];
  put(std::size_t{0}, std::size_t{corners[0]});
  put(n, std::size_t{corners[1]});
  put(row_start(n, n), std::size_t{corners[2]});
  for (std::uint32_t k = 0; k < 3 && n > 1; ++k) {
    const std::uint32_t e = patches.edge(patch, k);
    const bool same_way = patches.edges()[e].from == corners[k];
    const std::size_t start = patches.edge_start(e, level);
    for (std::size_t t = 1; t < n; ++t)
      put(k == 0 ? t : k == 1 ? row_start(t, n) + n - t : row_start(n - t, n), start + (same_way ? t : n - t) - 1);
  }
  std::size_t v = patches.inner_start(patch, level);
  for (std::size_t j = 1; j + 1 < n; ++j) {
    const std::size_t row = row_start(j, n);
    for (std::size_t i = 1; i + j < n; ++i) put(row + i, v++);
  }
}

/// Collects the vectors of a patch's vertices from `of`. Adds the vectors in `more`, unless `more` is empty.
inline void gather(const displaced::Patches& patches, std::uint32_t patch, int level, std::span<const glm::vec3> of,
                   std::span<const glm::vec3> more, Columns& to) {
  to.resize(((std::size_t{1} << level) + 1) * ((std::size_t{1} << level) + 2) / 2);
  const glm::vec3 *first = of.data(), *second = more.data();
  if (more.empty())
    for_each_of_grid(patches, patch, level, [&](std::size_t i, std::size_t v) { to.put(i, first[v]); });
  else
    for_each_of_grid(patches, patch, level, [&](std::size_t i, std::size_t v) { to.put(i, first[v] + second[v]); });
}

}  // namespace gs::qnv
