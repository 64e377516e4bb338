#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>

namespace gs::render {

/// Tile of samples: small enough for the second-level cache, and large enough that few splats touch more than one. It
/// consists of blocks of 4 x 4 consecutive samples, so that a small splat touches few cache lines. Splats process whole
/// units of 4 x 2 samples.
constexpr int kTile = 64, kBlock = 4, kUnitRows = 2, kBlockSamples = kBlock * kBlock;
constexpr int kBlocksAcross = kTile / kBlock, kBlocks = kBlocksAcross * kBlocksAcross;

/// Splat in view, ready to rasterize, in one cache line. Node space relative to the camera.
struct alignas(64) SplatDisc {
  // Inverse depth of its plane: at sample (0, 0), and the increment per sample to the right and up.
  float inverse, inverse_right, inverse_up;
  glm::vec3 place;  // centre of the splat
  float reach;      // half the edge of the cube, or the squared covering radius
  float offset;     // the cube's centre is place - offset * normal
  glm::vec3 normal;
  float quarter;        // 1 / (2 R)^2 of the bell
  std::uint32_t color;  // red, green << 8, blue << 16; kSplatBack
  // Insets from the bounds below to the samples that it may cover: left, bottom << 8, right << 16, top << 24.
  std::uint32_t inset;
  std::uint32_t low, high;  // samples that it may contribute to, inclusive: x | y << 16
};
static_assert(sizeof(SplatDisc) == 64);

/// Flag in SplatDisc::color: the back is visible.
constexpr std::uint32_t kSplatBack = 1u << 24;

/// Rays of a view, shared by all splats of a point set.
struct SplatRays {
  glm::vec3 origin, right, up;  // node space, depth 1: ray of sample (0, 0), and increments per sample
  float near_plane;
};

/// Properties shared by all splats of a point set.
struct SplatKind {
  bool cubes = false, colored = false;
  bool sides = false;   // two-sided
  bool smooth = false;  // normals follow the surface between the splats
};

/// Samples of one tile, block by block.
struct alignas(64) SplatTile {
  using Samples = std::array<float, kBlockSamples>;
  /// Sums to which every splat adds. Arrays of neighbouring blocks avoid distances of a multiple of 4 kB, where the CPU
  /// confuses stores with later loads.
  struct Sums {
    std::array<Samples, 3> point;  // on the nearest surface, node space
    Samples weight;
    std::array<Samples, 3> normal;
  };
  static constexpr int kStride = kBlocksAcross + 6;

  std::array<Samples, kBlocks> nearest;  // 1 / depth; after all splats, the depth
  // A ray of depth 1 is the sum of one for the column and one for the row of blocks.
  std::array<std::array<Samples, 3>, kBlocksAcross> rays_across, rays_up;
  std::array<Sums, std::size_t{kBlocksAcross} * kStride> sums;
  std::array<std::array<Samples, 3>, kBlocks> color;
  // Sums over the bells: their slopes, the slopes times the height over the splat's plane, and the bells times that
  // height.
  std::array<std::array<Samples, 7>, kBlocks> slopes;
  std::array<Samples, kBlocks> side;  // 1 if the nearest surface shows its back
  // Pixels, row by row, kTile per row.
  std::array<std::array<float, kTile * kTile>, 8> pixels;
};

}  // namespace gs::render
