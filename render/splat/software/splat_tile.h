#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>

namespace gs::render {

/// Samples along the side of a tile, of a block and of a unit. A tile fits the second-level cache, and few splats touch
/// more than one. It consists of blocks of 4 x 4 consecutive samples, so that a small splat touches few cache lines.
/// Splats process whole units of 4 x 2 samples.
constexpr int kTile = 64, kBlock = 4, kUnitRows = 2, kBlockSamples = kBlock * kBlock;
constexpr int kBlocksAcross = kTile / kBlock, kBlocks = kBlocksAcross * kBlocksAcross;

/// Splat that is in view and ready to rasterize, in one cache line. In node space, relative to the camera.
struct alignas(64) SplatDisc {
  // Inverse depth of its plane: at sample (0, 0), and its increase per sample to the right and upwards.
  float inverse, inverse_right, inverse_up;
  glm::vec3 place;  // centre of the splat
  float reach;      // half the edge of its cube, or the square of the radius that it covers
  float offset;     // the centre of its cube is place - offset * normal
  glm::vec3 normal;
  float quarter;        // 1 / (2 R)^2, with the radius R of its bell
  std::uint32_t color;  // red, green << 8, blue << 16; flag kSplatBack
  // Distances in samples from the bounds below to the samples that it may cover: left, bottom << 8, right << 16, top <<
  // 24.
  std::uint32_t inset;
  std::uint32_t low, high;  // first and last sample to which it may contribute: x | y << 16
};
static_assert(sizeof(SplatDisc) == 64);

/// Flag in SplatDisc::color: the back of the splat is visible.
constexpr std::uint32_t kSplatBack = 1u << 24;

/// Rays of a view, the same for all splats of a geometry.
struct SplatRays {
  glm::vec3 origin, right, up;  // node space, at depth 1: ray of sample (0, 0), and its increase per sample
  float near_plane;
};

/// Properties that all splats of a geometry share.
struct SplatKind {
  bool cubes = false, colored = false;
  bool sides = false;   // the splats are two-sided
  bool smooth = false;  // normals follow the surface between the splats
};

/// Samples of one tile, stored block by block.
struct alignas(64) SplatTile {
  using Samples = std::array<float, kBlockSamples>;
  /// Sums to which all splats add. Neighbouring arrays do not start at a distance of a multiple of 4 kB: the CPU would
  /// confuse stores with later loads.
  struct Sums {
    std::array<Samples, 3> point;  // point of the ray on the nearest surface, node space
    Samples weight;
    std::array<Samples, 3> normal;
  };
  static constexpr int kStride = kBlocksAcross + 6;

  std::array<Samples, kBlocks> nearest;  // 1 / depth of the nearest surface; after all splats, its depth
  // The ray of a sample at depth 1 is the sum of two parts: one of its column of blocks, one of its row of blocks.
  std::array<std::array<Samples, 3>, kBlocksAcross> rays_across, rays_up;
  std::array<Sums, std::size_t{kBlocksAcross} * kStride> sums;
  std::array<std::array<Samples, 3>, kBlocks> color;
  // Sums over the splats, for smooth normals (see splat_resolve_loop.inc). 0 to 2: gradient of the splat's weight. 3 to
  // 5: that gradient times the height of the sample above the splat's plane. 6: weight times height.
  std::array<std::array<Samples, 7>, kBlocks> slopes;
  std::array<Samples, kBlocks> side;  // 1 if the back of the nearest surface is visible
  // Values of pixels, with kTile pixels per row.
  std::array<std::array<float, kTile * kTile>, 8> pixels;
};

}  // namespace gs::render
