#include "qnv/codecs/values/labels/encode/label_uses.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <memory>

namespace gs::qnv::values {

namespace {

constexpr int kTileBits = std::countr_zero(kTileEdge), kCubeBits = std::countr_zero(kCubeEdge);

/// Counts of a tile: blocks of 2^shift voxels per axis, x first.
struct BlockCounts {
  int shift = 0;
  Extent size{};  // of the tile, in blocks
  std::vector<std::uint32_t> counts;

  void start(int bits, const Extent& voxels) {
    shift = bits;
    for (std::size_t a = 0; a < 3; ++a) size[a] = ((voxels[a] - 1) >> bits) + 1;
    counts.assign(sample_count(size), 0);
  }
  [[nodiscard]] std::uint32_t& at(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
    return counts[(std::size_t{z} * size[1] + y) * size[0] + x];
  }
};

/// Counts the uses of runs, tile by tile in the order of the codes. One thread at a time.
class UseCounter {
 public:
  UseCounter(const LabelPyramid::Levels& levels, std::span<const CubeOrder> orders,
             std::span<std::vector<StoredLabelRun>> runs, std::span<std::int64_t> all)
      : orders_(orders),
        runs_(runs),
        all_(all),
        current_(levels.size(), nullptr),
        sums_(levels.size(), 0),
        level_sums_(levels.size(), 0) {
    for (const StoredLabels& level : levels) tiles_.emplace_back(std::make_unique<LabelTiles>(level, 2));
  }
  ~UseCounter() {
    for (std::size_t level = 0; level < current_.size(); ++level) {
      flush(level);
      std::atomic_ref(all_[level]).fetch_add(level_sums_[level], std::memory_order_relaxed);
    }
  }
  UseCounter(const UseCounter&) = delete;
  UseCounter& operator=(const UseCounter&) = delete;

  void add(const Extent& tile) {
    const LabelTiles::Tile& truth = tiles_.front()->tile(tile);
    const std::size_t top = tiles_.size() - 1;
    if (truth.labels.empty() && top > kTileBits) return add_uniform(tile, truth);
    // Level 0 is right everywhere.
    BlockCounts right, before;
    right.start(kCubeBits, truth.size);
    for (std::uint32_t z = 0; z < truth.size[2]; ++z)
      for (std::uint32_t y = 0; y < truth.size[1]; ++y)
        for (std::uint32_t x = 0; x < truth.size[0]; ++x) ++right.at(x >> kCubeBits, y >> kCubeBits, z >> kCubeBits);
    for (std::size_t level = 0; level <= top; ++level) {
      if (level < top) count(tile, truth, level + 1, std::min(kTileBits, static_cast<int>(level) + kCubeBits), before);
      for (std::uint32_t z = 0; z < right.size[2]; ++z)
        for (std::uint32_t y = 0; y < right.size[1]; ++y)
          for (std::uint32_t x = 0; x < right.size[0]; ++x)
            add_block(tile, level, {x, y, z}, right.shift,
                      std::int64_t{right.at(x, y, z)} - (level < top ? std::int64_t{before.at(x, y, z)} : 0));
      if (level < top) merge(before, truth.size, std::min(kTileBits, static_cast<int>(level) + 1 + kCubeBits), right);
    }
  }

 private:
  // A tile with one label has it at all levels up to that of whole tiles.
  void add_uniform(const Extent& tile, const LabelTiles::Tile& truth) {
    const auto voxels = static_cast<std::int64_t>(sample_count(truth.size));
    bool right = true;
    for (std::size_t level = kTileBits; level < tiles_.size(); ++level) {
      const bool before = level + 1 < tiles_.size() && label_of(tile, level + 1) == truth.label;
      add_block(tile, level, {}, kTileBits, voxels * (int{right} - int{before}));
      right = before;
    }
  }

  // Returns the label that a level has for a whole tile.
  [[nodiscard]] std::uint32_t label_of(const Extent& tile, std::size_t level) {
    Extent at{}, in_tile{};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint32_t voxel = tile[a] << kTileBits >> level;
      at[a] = voxel >> kTileBits;
      in_tile[a] = voxel & (kTileEdge - 1);
    }
    return tiles_[level]->tile(at).at(in_tile[0], in_tile[1], in_tile[2]);
  }

  // Counts the voxels of a tile that are right at a level.
  void count(const Extent& tile, const LabelTiles::Tile& truth, std::size_t level, int shift, BlockCounts& to) {
    to.start(shift, truth.size);
    Extent at{}, first{};
    for (std::size_t a = 0; a < 3; ++a) {
      const std::uint32_t voxel = tile[a] << kTileBits >> level;
      at[a] = voxel >> kTileBits;
      first[a] = voxel & (kTileEdge - 1);
    }
    const LabelTiles::Tile& coarse = tiles_[level]->tile(at);
    for (std::uint32_t z = 0; z < truth.size[2]; ++z)
      for (std::uint32_t y = 0; y < truth.size[1]; ++y) {
        const std::uint32_t v = first[1] + (y >> level), w = first[2] + (z >> level);
        const std::uint32_t* const row =
            truth.labels.empty() ? nullptr : &truth.labels[(std::size_t{z} * truth.size[1] + y) * truth.size[0]];
        // One coarse label at a time.
        for (std::uint32_t x = 0; x < truth.size[0];) {
          const std::uint32_t end = std::min(((x >> level) + 1) << level, truth.size[0]);
          const std::uint32_t label = coarse.at(first[0] + (x >> level), v, w);
          const std::uint32_t block_end = std::min(end, ((x >> shift) + 1) << shift);
          std::uint32_t equal = 0;
          std::uint32_t& sum = to.at(x >> shift, y >> shift, z >> shift);
          for (; x < block_end; ++x) equal += (row ? row[x] : truth.label) == label ? 1 : 0;
          sum += equal;
        }
      }
  }

  static void merge(BlockCounts& fine, const Extent& voxels, int shift, BlockCounts& to) {
    const int by = shift - fine.shift;
    to.start(shift, voxels);
    for (std::uint32_t z = 0; z < fine.size[2]; ++z)
      for (std::uint32_t y = 0; y < fine.size[1]; ++y)
        for (std::uint32_t x = 0; x < fine.size[0]; ++x) to.at(x >> by, y >> by, z >> by) += fine.at(x, y, z);
  }

  void add_block(const Extent& tile, std::size_t level, const Extent& block, int shift, std::int64_t corrected) {
    if (corrected == 0) return;
    level_sums_[level] += corrected;
    Extent cube{};
    for (std::size_t a = 0; a < 3; ++a) cube[a] = ((tile[a] << kTileBits) + (block[a] << shift)) >> (level + kCubeBits);
    const std::uint64_t code = orders_[level].code(cube);
    StoredLabelRun*& run = current_[level];
    if (!run || code < run->first || code >= run->first + run->count) {
      flush(level);
      const auto after = std::ranges::upper_bound(runs_[level], code, {}, &StoredLabelRun::first);
      if (after == runs_[level].begin()) return;
      run = &*(after - 1);
      if (code >= run->first + run->count) {
        run = nullptr;
        return;
      }
    }
    sums_[level] += corrected;
  }
  void flush(std::size_t level) {
    if (current_[level]) std::atomic_ref(current_[level]->corrected).fetch_add(sums_[level], std::memory_order_relaxed);
    sums_[level] = 0;
  }

  std::span<const CubeOrder> orders_;
  std::span<std::vector<StoredLabelRun>> runs_;
  std::span<std::int64_t> all_;
  std::vector<std::unique_ptr<LabelTiles>> tiles_;  // by level
  std::vector<StoredLabelRun*> current_;            // by level, with the sums that it does not have yet
  std::vector<std::int64_t> sums_, level_sums_;
};

/// Number of voxels that a run or a level corrects, as counted by one rank.
struct CountedUse {
  std::uint64_t index = 0;  // index of the run in its level; unused for the sum of a level
  std::int64_t voxels = 0;
  std::uint32_t level = 0, of_level = 0;
};

// Adds the counts of all ranks.
void join_counts(Ranks& ranks, std::span<std::vector<StoredLabelRun>> runs, std::span<const std::int64_t> counted,
                 std::span<std::int64_t> sums) {
  std::vector<CountedUse> own;
  for (std::uint32_t level = 0; level < runs.size(); ++level) {
    own.push_back({0, counted[level], level, 1});
    for (std::size_t i = 0; i < runs[level].size(); ++i)
      if (runs[level][i].corrected != 0) own.push_back({i, std::exchange(runs[level][i].corrected, 0), level, 0});
  }
  for (const CountedUse& use : gather_records(ranks, std::span<const CountedUse>(own)))
    (use.of_level != 0 ? sums[use.level] : runs[use.level][static_cast<std::size_t>(use.index)].corrected) +=
        use.voxels;
}

}  // namespace

bool count_corrected(const LabelPyramid::Levels& levels, std::span<const CubeOrder> orders,
                     std::span<std::vector<StoredLabelRun>> runs, std::span<std::int64_t> sums, Ranks& ranks,
                     unsigned threads, Progress* progress) {
  constexpr std::uint64_t kParts = 64;
  const CubeOrder& order = orders.front();
  const int bits = order.bits_below(kTileBits - kCubeBits);
  const std::uint64_t tiles = order.codes() >> bits;
  const RankShare share = share_of(ranks, tiles);
  const std::uint64_t parts = std::min(kParts, share.size());
  std::vector<std::int64_t> counted(sums.size(), 0);
  const bool whole = parallel_for(
      static_cast<std::size_t>(parts),
      [&](std::size_t part) {
        UseCounter counter(levels, orders, runs, counted);
        const std::uint64_t end = share.first + share.size() * (part + 1) / parts;
        for (std::uint64_t code = share.first + share.size() * part / parts; code < end; ++code) {
          const Extent cube = order.place(code << bits);
          if (!order.has(cube)) continue;
          constexpr int kCubes = kTileBits - kCubeBits;
          counter.add({cube[0] >> kCubes, cube[1] >> kCubes, cube[2] >> kCubes});
        }
      },
      threads, progress);
  join_counts(ranks, runs, counted, sums);
  return whole;
}

}  // namespace gs::qnv::values
