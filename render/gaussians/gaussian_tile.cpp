#include "render/gaussians/gaussian_tile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "qnv/base/kernel_pragmas.inc"  // after all other includes

namespace gs::render {
namespace {

constexpr std::size_t kGaussiansUntilLook = 32;  // splats between two checks for groups without light
constexpr float kGaussianDark = 1 / 512.0f;      // maximum transmittance of an opaque pixel: half a step of 8 bits
constexpr float kGaussianHalf = 0.5f;            // the depth is recorded at this transmittance

namespace baseline {
#define GAUSSIAN_TARGET
#define GAUSSIAN_AVX2 0
#include "render/gaussians/gaussian_tile_loop.inc"
#undef GAUSSIAN_TARGET
#undef GAUSSIAN_AVX2
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
#define GAUSSIAN_TARGET __attribute__((target("avx2")))
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
  for (GaussianGroup& group : groups) group.clear.fill(1);
  open = kAllGroups;
}

const GaussianKernel& gaussian_kernel_baseline() { return kGaussianBaseline; }

const GaussianKernel& gaussian_kernel() {
#if defined(__x86_64__)
  static constexpr GaussianKernel kAvx2{avx2::tile<false>, avx2::tile<true>, avx2::write};
  static const bool have_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (have_avx2) return kAvx2;
#endif
  return kGaussianBaseline;
}

}  // namespace gs::render
