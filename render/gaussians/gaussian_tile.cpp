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
#define LANES_TARGET
#define LANES_AVX2 0
#define LANES_AVX512 0
#include "render/gaussians/gaussian_tile_loop.inc"
#undef LANES_TARGET
#undef LANES_AVX2
#undef LANES_AVX512
}  // namespace baseline

#if defined(__x86_64__)
namespace avx2 {
#define LANES_TARGET __attribute__((target("avx2,bmi")))
#define LANES_AVX2 1
#define LANES_AVX512 0
#include "render/gaussians/gaussian_tile_loop.inc"
#undef LANES_TARGET
#undef LANES_AVX2
#undef LANES_AVX512
}  // namespace avx2

// Without AVX-512VL, GCC keeps vectors of eight numbers in AVX2, where their comparisons are faster.
namespace avx512 {
#define LANES_TARGET __attribute__((target("avx2,bmi,bmi2,avx512f")))
#define LANES_AVX2 1
#define LANES_AVX512 1
#include "render/gaussians/gaussian_tile_loop.inc"
#undef LANES_TARGET
#undef LANES_AVX2
#undef LANES_AVX512
}  // namespace avx512
#endif

}  // namespace

void GaussianTile::clear_pixels() {
  blocks.fill({});
  for (std::size_t i = 0; i < kBlocks; ++i) {
    std::ranges::fill(blocks[i].channel(GaussianBlock::kClear), 1.0f);
    for (std::size_t lane = 0; lane < GaussianBlock::kLanes; ++lane)
      blocks[i].channel(GaussianBlock::kColumn)[lane] =
          static_cast<float>(i / 4 * 4 + lane % GaussianBlock::kGroupLanes / 2);
  }
  open = kAllGroups;
  with_depths = true;
}

std::span<const GaussianKernel> gaussian_kernels() {
#if defined(__x86_64__)
  static constexpr std::array<GaussianKernel, 3> kAll{{{baseline::tile<false>, baseline::tile<true>, baseline::write},
                                                       {avx2::tile<false>, avx2::tile<true>, avx2::write},
                                                       {avx512::tile<false>, avx512::tile<true>, avx512::write}}};
  static const std::size_t count = [] {
    const bool have_avx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0;
    const bool have_avx512 = __builtin_cpu_supports("bmi2") != 0 && __builtin_cpu_supports("avx512f") != 0;
    return std::size_t{1} + (have_avx2 ? 1 : 0) + (have_avx2 && have_avx512 ? 1 : 0);
  }();
#else
  static constexpr std::array<GaussianKernel, 1> kAll{{{baseline::tile<false>, baseline::tile<true>, baseline::write}}};
  static constexpr std::size_t count = 1;
#endif
  return std::span(kAll).first(count);
}

const GaussianKernel& gaussian_kernel() { return gaussian_kernels().back(); }

}  // namespace gs::render
