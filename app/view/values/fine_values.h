#pragma once

#include "app/view/values/volume_grid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::app {

/// Values of a grid and its finer parts, as a finer grid. Sample s of an axis lies at voxel s / factor. Where a part is
/// finer or coarser than that, the nearest value counts.
class FineValues {
 public:
  /// `factor` is a power of two. It is 1 on an axis of one voxel. `grid` must stay valid.
  FineValues(const VolumeGrid& grid, std::uint32_t factor);

  /// Returns the largest useful factor for which size() has at most `most` samples, on all axes or without one of them.
  [[nodiscard]] static std::uint32_t factor_for(const VolumeGrid& grid, std::size_t most, int without = -1);

  [[nodiscard]] const std::array<std::uint32_t, 3>& size() const { return size_; }
  [[nodiscard]] const std::array<std::uint32_t, 3>& factors() const { return factors_; }
  /// Reads the values of a box, x first. Missing values are NaN.
  void read(const std::array<std::uint32_t, 3>& first, const std::array<std::uint32_t, 3>& count,
            std::vector<float>& values) const;

 private:
  const VolumeGrid& grid_;
  std::array<std::uint32_t, 3> factors_{1, 1, 1}, size_{};
};

}  // namespace gs::app
