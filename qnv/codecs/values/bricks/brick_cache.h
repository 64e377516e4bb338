#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/values/bricks/block_cache.h"
#include "qnv/codecs/values/bricks/brick_choice.h"
#include "qnv/codecs/values/bricks/brick_samples.h"
#include "qnv/codecs/values/bricks/brick_vectors.h"
#include "qnv/codecs/values/bricks/gap_runs.h"
#include "qnv/codecs/values/decode/sample_limits.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::qnv::values {

/// Sample of a missing voxel in a brick of level 0.
inline constexpr std::int32_t kMissingInBrick = std::numeric_limits<std::int32_t>::min();

/// Decoded brick.
struct Brick {
  BrickName name;
  std::shared_ptr<const BrickSamples> samples;  // with the margin
  std::vector<BrickVector> vectors;             // more than are shown
  double wanted = 0;                            // number of vectors for the share of the coarser vectors
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(*this) + samples->bytes() + vectors.capacity() * sizeof(BrickVector);
  }
};

/// Samples of the level that viewers have as a whole.
struct BrickBase {
  BrickSamples samples;
  std::uint64_t version = 0;  // changes with the samples
  SampleLimits limits{};      // of level 0
  VectorShares shares;
};

/// Decoded bricks of a volume, and the blocks that they come from. One thread at a time.
class BrickCache : NonCopyable {
 public:
  /// `levels` are the layouts of the levels 0 to BrickLayout::base(). Both must stay valid.
  BrickCache(const BrickLayout& layout, std::span<const VolumeLayout> levels)
      : layout_(layout), levels_(levels), blocks_(layout.blocks()) {}

  /// Computes the chosen bricks from all received data. Blocks outside of these bricks count as zero. If all bricks
  /// need more than `most_bytes`, drops other bricks, the least recently chosen first. Returns false if `stop` was set.
  bool update(std::span<const BrickName> chosen, const BrickBase& base, const ClusterChunks& chunks,
              const GapRuns& gaps, std::size_t most_bytes, const std::atomic<bool>& stop);
  /// Returns a brick, or null. Only chosen bricks are up to date.
  [[nodiscard]] const Brick* find(const BrickName& name) const;
  [[nodiscard]] std::size_t bytes() const { return bytes_ + blocks_.bytes(); }
  [[nodiscard]] std::size_t count() const { return bricks_.size(); }
  /// Reports whether a block belongs to a chosen brick.
  [[nodiscard]] bool uses(std::uint64_t block) const { return used_blocks_.contains(block); }
  /// Returns the number of bricks that the last update computed.
  [[nodiscard]] std::size_t computed() const { return computed_; }

 private:
  struct State {
    Brick brick;
    std::uint64_t key = 0;  // of everything that the brick comes from
    std::uint64_t used = 0;
  };
  /// Brick to compute, with the blocks around it.
  struct Work {
    State* state = nullptr;
    const BrickSamples* coarser = nullptr;
    std::vector<std::uint64_t> blocks;
  };
  [[nodiscard]] std::uint64_t key_of(const BrickName& name, const BrickBase& base, const ClusterChunks& chunks,
                                     const GapRuns& gaps, std::vector<std::uint64_t>& blocks) const;
  void compute(const Work& work, const BrickBase& base, const GapRuns& gaps) const;
  void trim(std::size_t most_bytes);

  const BrickLayout& layout_;
  std::span<const VolumeLayout> levels_;
  BlockCache blocks_;
  std::unordered_set<std::uint64_t> used_blocks_;  // of the chosen bricks
  std::unordered_map<BrickName, State, BrickNameHash> bricks_;
  std::size_t bytes_ = 0, computed_ = 0;
  std::uint64_t time_ = 0;
};

}  // namespace gs::qnv::values
