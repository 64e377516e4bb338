#pragma once

#include "qnv/codecs/values/lifting.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gs::qnv::values {

/// Edge of a block in each band, and of the cubes that it consists of, in coefficients.
inline constexpr std::uint32_t kBlockEdge = 16, kCubeEdge = 4;
inline constexpr std::uint32_t kCubeSize = kCubeEdge * kCubeEdge * kCubeEdge;

/// Cuboid of coefficients in the transformed volume.
struct BandPart {
  Extent first{}, size{};
  int highs = 0;  // number of axes on which the band is high
};

/// Box of space at one level: the same part of each band of the level.
struct BlockPlace {
  int level = 0;           // number of inverse steps from its bands to the full volume; 1 is the finest
  Extent first{}, size{};  // box in the samples of the volume
  std::uint32_t band_count = 0;
  std::array<BandPart, 8> bands{};
};

/// Blocks of a volume. They are numbered from the coarsest level to the finest; within a level, x first.
class BlockLayout {
 public:
  BlockLayout(Extent extent, int levels);

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Returns the number of blocks of a level.
  [[nodiscard]] std::uint64_t count_of(int level) const;
  /// Returns the number of the block at a place of a level: its part of each band, counted in blocks.
  [[nodiscard]] std::uint64_t number(int level, Extent at) const;
  /// Returns the number of the first block of a level, and the blocks of a level per axis.
  [[nodiscard]] std::uint64_t first_of(int level) const;
  [[nodiscard]] Extent blocks_of(int level) const;
  /// Returns a block. `number` must be less than count().
  [[nodiscard]] BlockPlace place(std::uint64_t number) const;

 private:
  struct Level {
    int level = 0;
    Extent whole{}, low{}, blocks{};     // samples that it gives, its low band, blocks per axis
    std::uint64_t first = 0, count = 0;  // block numbers
  };
  Extent extent_;
  int levels_;
  std::uint64_t count_ = 0;
  std::vector<Level> all_;  // coarsest first
};

/// Returns the weight of a squared error in a band for the squared error of the volume.
[[nodiscard]] double error_weight(int level, int highs);

}  // namespace gs::qnv::values
