#include "qnv/codecs/displaced/tessellation/patch_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "qnv/base/kernel_pragmas.inc"  // after all other includes

namespace gs::qnv {
namespace {

using displaced::kLayers;
using displaced::row_start;

namespace baseline {
#define PATCH_LANES 4
#define PATCH_TARGET
#include "qnv/codecs/displaced/tessellation/patch_loops.inc"
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
#define PATCH_LANES 8
#define PATCH_TARGET __attribute__((target("avx2")))
#include "qnv/codecs/displaced/tessellation/patch_loops.inc"
}  // namespace avx2
#endif

constexpr PatchLoops kPatchLoops[] = {
#if defined(__x86_64__)
    {"AVX2", avx2::products, avx2::inner_normals, avx2::middles, avx2::pack_directions, avx2::leave_frame,
     avx2::directions, avx2::least_cosine, avx2::farthest},
    {"SSE2", baseline::products, baseline::inner_normals, baseline::middles, baseline::pack_directions,
     baseline::leave_frame, baseline::directions, baseline::least_cosine, baseline::farthest},
#else
    {"baseline", baseline::products, baseline::inner_normals, baseline::middles, baseline::pack_directions,
     baseline::leave_frame, baseline::directions, baseline::least_cosine, baseline::farthest},
#endif
};

}  // namespace

std::span<const PatchLoops> patch_loops() {
  std::size_t first = 0;
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2")) first = 1;
#endif
  return std::span(kPatchLoops).subspan(first);
}

}  // namespace gs::qnv
