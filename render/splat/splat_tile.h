#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>

namespace gs::render {

/// A tile of samples: small enough to stay in the second cache, and large enough that few discs meet more than one. It
/// is made of blocks of 4 x 4 samples that lie together in memory, so that a small disc touches few cache lines; discs
/// touch whole units of 4 x 2 samples.
constexpr int kTile = 64, kBlock = 4, kUnitRows = 2, kBlockSamples = kBlock * kBlock;
constexpr int kBlocksAcross = kTile / kBlock, kBlocks = kBlocksAcross * kBlocksAcross;

/// A disc in view, ready to be rasterised, in one cache line. Node space, from the camera's place.
struct alignas(64) SplatDisc {
  // Of the depth of its plane: at sample (0, 0), and what a sample to the right or up adds.
  float inverse, inverse_right, inverse_up;
  glm::vec3 place;  // the disc's centre
  float reach;      // half the edge of the cube, or the square of the covering radius
  float offset;     // the cube's centre is place - offset * normal
  glm::vec3 normal;
  float quarter;        // 1 / (2 R)^2 of the bell
  std::uint32_t color;  // red, green << 8, blue << 16; kSplatBack
  // The samples that it may cover lie so much further in than those that it may count in: left, bottom << 8,
  // right << 16, top << 24.
  std::uint32_t inset;
  std::uint32_t low, high;  // the samples that it may count in, inclusive: x | y << 16
};
static_assert(sizeof(SplatDisc) == 64);

/// In SplatDisc::color: its back is seen.
constexpr std::uint32_t kSplatBack = 1u << 24;

/// What all discs of a cloud share.
struct SplatRays {
  glm::vec3 origin, right, up;  // node space: ray of sample (0, 0), and what one sample adds; of depth 1
  float near_plane;
};

/// What is the same for all discs of a cloud.
struct SplatKind {
  bool cubes = false, colored = false;
  bool sides = false;   // seen from behind too
  bool smooth = false;  // the normals follow the surface between the discs
};

/// The samples of one tile, a block after the other.
struct alignas(64) SplatTile {
  using Samples = std::array<float, kBlockSamples>;
  /// What every disc adds to. Arrays of neighbouring blocks do not lie a multiple of 4 kB apart: a processor would take
  /// what is written to one for what is read from the other.
  struct Sums {
    std::array<Samples, 3> point;  // of the nearest surface, node space
    Samples weight;
    std::array<Samples, 3> normal;
  };
  static constexpr int kStride = kBlocksAcross + 6;

  std::array<Samples, kBlocks> nearest;  // 1 / depth; once all discs are in, the depth
  // Rays of depth 1 are the sums of one for the column and one for the row of blocks.
  std::array<std::array<Samples, 3>, kBlocksAcross> rays_across, rays_up;
  std::array<Sums, std::size_t{kBlocksAcross} * kStride> sums;
  std::array<std::array<Samples, 3>, kBlocks> color;
  // Of the bells: sums of their slopes, of the slopes times the height over the disc's plane, and of the bells
  // themselves times it.
  std::array<std::array<Samples, 7>, kBlocks> slopes;
  std::array<Samples, kBlocks> side;  // 1: the nearest surface shows its back
  // Of pixels, row by row, kTile a row.
  std::array<std::array<float, kTile * kTile>, 8> pixels;
};

}  // namespace gs::render
