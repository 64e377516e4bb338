#pragma once

#include "qnv/codecs/shared/ranks.h"
#include "qnv/codecs/values/slices/level_slices.h"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace gs::qnv::values {

/// Transform of a volume that arrives slice by slice. Keeps about 45 slices of the finest level, and a quarter of that
/// for each coarser one. One thread at a time.
class SliceTransform {
 public:
  /// Function that takes a complete row of blocks: the blocks `first` to `first + count - 1` of the layout, with the
  /// slices of their level. It returns false to stop.
  using TakeBlocks = std::function<bool(std::uint64_t first, std::uint32_t count, LevelSlices& slices)>;

  SliceTransform(Extent extent, unsigned threads, TakeBlocks take);

  /// Adds the next slices of the volume. Returns false if `take` did.
  bool add(std::span<const SliceRows> slices) { return add(0, slices); }

 private:
  struct Level {
    LevelSlices slices;
    std::uint64_t first_block;
    std::uint32_t blocks_in_row;
    std::uint32_t rows = 0;  // number of rows of blocks that are complete
  };
  bool add(std::size_t level, std::span<const SliceRows> slices);

  unsigned threads_;
  TakeBlocks take_;
  std::vector<Level> levels_;  // finest first
};

/// Transform of one level of a volume, for some consecutive rows of blocks along z. One thread at a time.
class RowTransform {
 public:
  /// Function that receives a complete row of blocks, with the slices of its level. It returns false to stop.
  using TakeRow = std::function<bool(std::uint32_t row, LevelSlices& slices)>;

  RowTransform(Extent extent, int level, RankShare rows, unsigned threads, TakeRow take);

  /// Returns the slices that these rows depend on, of the level below or of the volume.
  [[nodiscard]] static SliceWindow window_of(Extent extent, int level, RankShare rows);
  /// Adds the next slices of the window. Returns false if `take` returned false.
  bool add(std::span<const SliceRows> slices);

 private:
  unsigned threads_;
  RankShare rows_;
  std::uint32_t next_;
  TakeRow take_;
  LevelSlices slices_;
};

/// Inverse transform that gives the slices of a volume, or of a window of it, in order. Memory as SliceTransform. One
/// thread at a time.
class SliceRestorer {
 public:
  /// Function that writes the coefficients of a block that are not zero. Several threads call it.
  using WriteBlock = std::function<void(std::uint64_t number, const BlockPlace& place, const BlockBands& bands)>;

  SliceRestorer(Extent extent, unsigned threads, WriteBlock write, SliceWindow window = {});

  /// Gives the next slices of the volume.
  void next(std::span<const SliceRows> slices) { next(0, slices); }

 private:
  struct Level {
    LevelSlices slices;
    std::uint64_t first_block;
    std::uint32_t blocks_in_row;
    std::uint32_t rows = 0, given = 0;  // ends of the rows of blocks that are decoded, and of the given slices
  };
  void next(std::size_t level, std::span<const SliceRows> slices);
  void decode_row(std::size_t level);

  unsigned threads_;
  bool transformed_;
  WriteBlock write_;
  BlockLayout layout_;
  std::vector<Level> levels_;  // finest first
};

}  // namespace gs::qnv::values
