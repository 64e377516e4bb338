#include "render/volume/volume_tile.h"

#include <algorithm>
#include <cmath>
#include <cstring>

// All functions with vector parameters are inlined, so warnings about their calling convention do not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace gs::render {
namespace {

constexpr std::size_t kLookEvery = 64;  // splats between two checks whether the tile is opaque
constexpr int kBlocks = kVolumeTile / 8;  // blocks along the side of a tile
constexpr float kOpaque = 1 / 512.0f;  // maximum transmittance of an opaque pixel: at most half a step of 8 bits
constexpr float kSolid = 0.5f;  // the depth is recorded at this transmittance

namespace baseline {
#define VOLUME_TARGET
#include "render/volume/volume_tile_loop.inc"
#undef VOLUME_TARGET
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
// No fused multiply-add, so that both kernels give identical bits.
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
