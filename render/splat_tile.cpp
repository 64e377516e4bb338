#include "render/splat_tile.h"

#include <algorithm>
#include <cstring>

// Everything that takes or gives a vector is inlined, so that no calling convention matters.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace gs::render {
namespace {

constexpr float kFar = 1e30f;

namespace baseline {
#define SPLAT_TARGET
#include "render/splat_tile_loop.h"
#undef SPLAT_TARGET
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
// Without fused multiplications, so that both give the same bits.
#define SPLAT_TARGET __attribute__((target("avx2")))
#include "render/splat_tile_loop.h"
#undef SPLAT_TARGET
}  // namespace avx2
#endif

constexpr SplatKernel kBaseline{baseline::tile};

}  // namespace

const SplatKernel& splat_kernel_baseline() { return kBaseline; }

const SplatKernel& splat_kernel() {
#if defined(__x86_64__)
  static constexpr SplatKernel kAvx2{avx2::tile};
  static const bool have_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (have_avx2) return kAvx2;
#endif
  return kBaseline;
}

}  // namespace gs::render
