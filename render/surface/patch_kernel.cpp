#include "render/surface/patch_kernel.h"

#include "render/splat/software/splat_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "qnv/base/kernel_pragmas.inc"  // after all other includes

namespace gs::render {
namespace {

namespace baseline {
#define SPLAT_LANES 4
#define SPLAT_TARGET
#include "render/surface/patch_loops.inc"
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
#define SPLAT_LANES 8
#define SPLAT_TARGET __attribute__((target("avx2,popcnt")))
#include "render/surface/patch_loops.inc"
}  // namespace avx2
#endif

constexpr PatchKernel kPatchKernels[] = {
#if defined(__x86_64__)
    {"AVX2", avx2::project, avx2::sift, avx2::draw_small, avx2::draw_large, avx2::resolve, avx2::leave_empty},
    {"SSE2", baseline::project, baseline::sift, baseline::draw_small, baseline::draw_large, baseline::resolve,
     baseline::leave_empty},
#else
    {"baseline", baseline::project, baseline::sift, baseline::draw_small, baseline::draw_large, baseline::resolve,
     baseline::leave_empty},
#endif
};

}  // namespace

std::span<const PatchKernel> patch_kernels() {
  std::size_t first = 0;
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2")) first = 1;
#endif
  return std::span(kPatchKernels).subspan(first);
}

}  // namespace gs::render
