#include "render/gaussians/gaussian_ellipse.h"

#include "render/gaussians/gaussian_raster.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "qnv/base/kernel_pragmas.inc"  // after all other includes

namespace gs::render {
namespace {

constexpr float kMostFloat = std::numeric_limits<float>::max();

namespace baseline {
#define LANES_TARGET
#define LANES_AVX2 0
#include "render/gaussians/gaussian_ellipse_loop.inc"
#undef LANES_TARGET
#undef LANES_AVX2
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
#define LANES_TARGET __attribute__((target("avx2")))
#define LANES_AVX2 1
#include "render/gaussians/gaussian_ellipse_loop.inc"
#undef LANES_TARGET
#undef LANES_AVX2
}  // namespace avx2
#endif

}  // namespace

GaussianEllipses gaussian_ellipses_baseline() { return baseline::ellipses; }

GaussianEllipses gaussian_ellipses() {
#if defined(__x86_64__)
  static const bool have_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (have_avx2) return avx2::ellipses;
#endif
  return gaussian_ellipses_baseline();
}

}  // namespace gs::render
