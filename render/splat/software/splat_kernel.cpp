#include "render/splat/software/splat_kernel.h"

#include "render/splat/software/splat_constants.h"
#include "render/splat/software/splat_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "qnv/base/kernel_pragmas.inc"  // after all other includes

namespace gs::render {
namespace {

using namespace splat;

constexpr std::array<std::uint32_t, 16> kLaneNumbers = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
// Positions of the samples in a block: x, then y.
constexpr std::array<float, kBlockSamples> kBlockX = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
constexpr std::array<float, kBlockSamples> kBlockY = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

namespace baseline {
#define SPLAT_LANES 4
#define SPLAT_TARGET
#include "render/splat/software/splat_loops.inc"
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
#define SPLAT_LANES 8
#define SPLAT_TARGET __attribute__((target("avx2,popcnt")))
#include "render/splat/software/splat_loops.inc"
}  // namespace avx2

namespace avx512 {
#define SPLAT_LANES 16
#define SPLAT_TARGET __attribute__((target("avx512f,avx512dq,avx512vl,popcnt")))
#include "render/splat/software/splat_loops.inc"
}  // namespace avx512
#endif

constexpr SplatKernel kKernels[] = {
#if defined(__x86_64__)
    {"AVX-512", avx512::prepare, avx512::draw},
    {"AVX2", avx2::prepare, avx2::draw},
    {"SSE2", baseline::prepare, baseline::draw},
#else
    {"baseline", baseline::prepare, baseline::draw},
#endif
};

std::size_t unsupported() {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2")) return 2;
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq") || !__builtin_cpu_supports("avx512vl"))
    return 1;
#endif
  return 0;
}

}  // namespace

std::span<const SplatKernel> splat_kernels() {
  static const std::size_t first = unsupported();
  return std::span(kKernels).subspan(first);
}

}  // namespace gs::render
