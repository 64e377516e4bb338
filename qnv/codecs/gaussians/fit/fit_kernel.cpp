#include "qnv/codecs/gaussians/fit/fit_kernel.h"

#include <array>
#include <cmath>
#include <cstring>

#include "qnv/base/kernel_pragmas.inc"  // after all other includes

namespace gs::qnv::gaussians {
namespace {

constexpr std::size_t kFitUntilLook = 16;     // Gaussians between two checks for opaque tiles
constexpr float kFitDark = 1 / 512.0f;        // maximum transmittance of an opaque pixel
constexpr float kFitLeastPower = -7.994353f;  // binary logarithm of 1/255, the minimum opacity
constexpr float kFitMostAlpha = 0.99f;        // maximum opacity of one Gaussian

namespace fit_baseline {
#define LANES_TARGET
#define LANES_AVX2 0
#include "qnv/codecs/gaussians/fit/fit_loop.inc"
#undef LANES_TARGET
#undef LANES_AVX2
}  // namespace fit_baseline

#if defined(__x86_64__)
namespace fit_avx2 {
#define LANES_TARGET __attribute__((target("avx2")))
#define LANES_AVX2 1
#include "qnv/codecs/gaussians/fit/fit_loop.inc"
#undef LANES_TARGET
#undef LANES_AVX2
}  // namespace fit_avx2
#endif

constexpr FitKernel kFitBaseline{fit_baseline::blend, fit_baseline::differentiate};

}  // namespace

const FitKernel& fit_kernel_baseline() { return kFitBaseline; }

const FitKernel& fit_kernel() {
#if defined(__x86_64__)
  static constexpr FitKernel kAvx2{fit_avx2::blend, fit_avx2::differentiate};
  static const bool have_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (have_avx2) return kAvx2;
#endif
  return kFitBaseline;
}

}  // namespace gs::qnv::gaussians
