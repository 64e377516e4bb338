#include "render/gaussians/gaussian_tile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "qnv/base/kernel_pragmas.inc"  // after all other includes

namespace gs::render {
namespace {

constexpr std::size_t kGaussiansUntilLook = 32;  // splats between two checks for opaque groups
constexpr float kGaussianDark = 1 / 512.0f;      // maximum transmittance of an opaque pixel: half a step of 8 bits
constexpr float kGaussianHalf = 0.5f;            // the depth is recorded at this transmittance

/// Bit masks of the groups from, and up to, each column and each row of pixels.
struct GroupMasks {
  std::array<std::uint64_t, kGaussianTile> from_column{}, to_column{}, from_row{}, to_row{};
};
constexpr GroupMasks kGroupMasks = [] {
  GroupMasks masks;
  for (std::size_t pixel = 0; pixel < kGaussianTile; ++pixel)
    for (std::size_t group = 0; group < GaussianTile::kGroups; ++group) {
      const std::uint64_t bit = std::uint64_t{1} << (2 * group);
      if (group / 8 >= pixel / 4) masks.from_column[pixel] |= bit;
      if (group / 8 <= pixel / 4) masks.to_column[pixel] |= bit;
      if (group % 8 >= pixel / 2) masks.from_row[pixel] |= bit;
      if (group % 8 <= pixel / 2) masks.to_row[pixel] |= bit;
    }
  return masks;
}();

namespace baseline {
#define GAUSSIAN_TARGET
#define GAUSSIAN_AVX2 0
#include "render/gaussians/gaussian_tile_loop.inc"
#undef GAUSSIAN_TARGET
#undef GAUSSIAN_AVX2
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
#define GAUSSIAN_TARGET __attribute__((target("avx2,bmi")))
#define GAUSSIAN_AVX2 1
#include "render/gaussians/gaussian_tile_loop.inc"
#undef GAUSSIAN_TARGET
#undef GAUSSIAN_AVX2
}  // namespace avx2
#endif

constexpr GaussianKernel kGaussianBaseline{baseline::tile<false>, baseline::tile<true>, baseline::write};

}  // namespace

void GaussianTile::clear_pixels() {
  groups.fill({});
  for (std::size_t i = 0; i < kGroups; ++i) {
    groups[i].clear.fill(1);
    for (std::size_t lane = 0; lane < GaussianGroup::kLanes; ++lane)
      groups[i].column[lane] = static_cast<float>(i / 8 * 4 + lane / 2);
  }
  open = kAllGroups;
  with_depths = true;
}

const GaussianKernel& gaussian_kernel_baseline() { return kGaussianBaseline; }

const GaussianKernel& gaussian_kernel() {
#if defined(__x86_64__)
  static constexpr GaussianKernel kAvx2{avx2::tile<false>, avx2::tile<true>, avx2::write};
  static const bool have_avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0;
  if (have_avx2) return kAvx2;
#endif
  return kGaussianBaseline;
}

}  // namespace gs::render
