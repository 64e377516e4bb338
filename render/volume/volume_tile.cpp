#include "render/volume/volume_tile.h"

#include <algorithm>
#include <cmath>
#include <cstring>

// All functions with vector parameters are inlined, so the calling convention does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace gs::render {
namespace {

constexpr std::size_t kLookEvery = 64;    // splats between two checks for an opaque tile
constexpr int kBlocks = kVolumeTile / 8;  // along an edge of a tile
constexpr float kOpaque = 1 / 512.0f;     // transmittance below which a pixel is opaque: at most half an 8-bit step
constexpr float kSolid = 0.5f;            // transmittance at which the depth is recorded

namespace baseline {
#define VOLUME_TARGET
#include "render/volume/volume_tile_loop.inc"
#undef VOLUME_TARGET
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
// Without fused multiply-add, so that both give the same bits.
#define VOLUME_TARGET __attribute__((target("avx2")))
#include "render/volume/volume_tile_loop.inc"
#undef VOLUME_TARGET
}  // namespace avx2
#endif

constexpr VolumeKernel kBaseline{baseline::tile<false>, baseline::tile<true>};

}  // namespace

const VolumeKernel& volume_kernel_baseline() { return kBaseline; }

const VolumeKernel& volume_kernel() {
#if defined(__x86_64__)
  static constexpr VolumeKernel kAvx2{avx2::tile<false>, avx2::tile<true>};
  static const bool have_avx2 = __builtin_cpu_supports("avx2") != 0;
  if (have_avx2) return kAvx2;
#endif
  return kBaseline;
}

}  // namespace gs::render
