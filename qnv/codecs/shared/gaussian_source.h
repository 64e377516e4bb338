#pragma once

#include "qnv/base/geometry.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace gs::qnv {

/// Source of Gaussians in pieces, so that they may exceed memory.
struct GaussianSource {
  GeometryBase base;  // the box may be empty
  int degree = 0;
  bool antialiased = false;
  std::uint64_t count = 0;  // number of Gaussians
  /// Passes all Gaussians to `take`, in pieces of any size. Each call passes the same Gaussians in the same order.
  /// Users read only positions, scales, rotations, opacities, bases and harmonics. Returns false if `take` did, or if
  /// reading failed.
  std::function<bool(const std::function<bool(const Gaussians&)>& take)> read;
  /// Number of Gaussians in each run, in the order of read(). Ranks that share the source read different runs. Empty
  /// means a single run.
  std::vector<std::uint64_t> runs{};
  /// Passes the Gaussians of one run to `take`, like read().
  std::function<bool(std::uint64_t run, const std::function<bool(const Gaussians&)>& take)> read_run{};
};

}  // namespace gs::qnv
