#pragma once

#include "base/noncopyable.h"
#include "qnv/codecs/values/bricks/block_cache.h"
#include "qnv/codecs/values/bricks/brick_choice.h"
#include "qnv/codecs/values/bricks/brick_samples.h"
#include "qnv/codecs/values/bricks/brick_vectors.h"
#include "qnv/codecs/values/bricks/final_cubes.h"
#include "qnv/codecs/values/bricks/received/gap_runs.h"
#include "qnv/codecs/values/bricks/received/remainder_runs.h"
#include "qnv/codecs/values/decode/sample_limits.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::qnv::values {

/// Decoded brick.
struct Brick {
  BrickName name;
  std::shared_ptr<const BrickSamples> samples;  // with the margin
  std::vector<BrickVector> vectors;             // more than are shown
  double wanted = 0;                            // number of vectors for the share of the coarser vectors
  CubeFlags final;                              // no further chunk changes these; level 0: the last error holds
  bool stored = false;                          // samples are stored numbers, see apply_remainders()
  [[nodiscard]] std::size_t bytes() const {
    return sizeof(*this) + samples->bytes() + vectors.capacity() * sizeof(BrickVector) + final.flags.size();
  }
};

/// Samples of the level that viewers have as a whole.
struct BrickBase {
  std::shared_ptr<const BrickSamples> samples;
  std::uint64_t version = 0;  // changes with the samples
  bool final = false;         // no further chunk changes the samples, and the places of all chunks are known
  SampleLimits limits{};      // of level 0
  VectorShares shares;
};

/// Data that bricks come from.
struct BrickSources {
  const BrickBase& base;
  const ClusterChunks& chunks;
  const GapRuns& gaps;
  const RemainderRuns& remainders;
  const StepChain& chain;
};

/// Bricks that views need. `chosen` has each after the one that contains it.
struct BrickNeeds {
  std::vector<BrickName> chosen;
  std::unordered_set<BrickName, BrickNameHash> exact;  // those of level 0 that get remainders
  std::unordered_set<std::uint64_t> blocks;            // blocks of the chosen bricks, and around exact ones
};

/// Decoded bricks of a volume, and the blocks that they come from. One thread at a time.
class BrickCache : NonCopyable {
 public:
  /// `levels` are the layouts of the levels 0 to BrickLayout::base(). All must stay valid.
  BrickCache(const BrickLayout& layout, std::span<const VolumeLayout> levels, const ValueGrid& grid)
      : layout_(layout), levels_(levels), grid_(grid), blocks_(layout.blocks()) {}

  /// Computes the chosen bricks from all received data. Other blocks than the needed ones count as zero. If all bricks
  /// need more than `most_bytes`, drops other bricks, the least recently chosen first. Calls `before_change` before the
  /// first brick is replaced. Returns false if `stop` was set.
  bool update(const BrickNeeds& needs, const BrickSources& sources, std::size_t most_bytes,
              const std::atomic<bool>& stop, const std::function<void()>& before_change);
  /// Returns a brick, or null. Only chosen bricks are up to date.
  [[nodiscard]] const Brick* find(const BrickName& name) const;
  [[nodiscard]] std::size_t bytes() const { return bytes_ + blocks_.bytes(); }
  [[nodiscard]] std::size_t count() const { return bricks_.size(); }
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
    const Brick* parent = nullptr;      // null means the level that viewers have as a whole
    std::vector<std::uint64_t> blocks;  // those of a place after each other, in the order of their steps
    bool exact = false;
  };
  [[nodiscard]] std::uint64_t key_of(const BrickName& name, const BrickNeeds& needs, const BrickSources& sources,
                                     std::vector<std::uint64_t>& blocks) const;
  void compute(const Work& work, const BrickNeeds& needs, const BrickSources& sources) const;
  [[nodiscard]] std::vector<const Block*> parts_of(std::span<const std::uint64_t> blocks) const;
  void finish(Brick& brick, BrickSamples& made, std::span<const std::int32_t> raw, const BrickSources& sources) const;
  void make_room(const BrickNeeds& needs, const BrickBase& base, std::size_t most_bytes);
  void trim(std::size_t most_bytes);

  const BrickLayout& layout_;
  std::span<const VolumeLayout> levels_;
  const ValueGrid& grid_;
  BlockCache blocks_;
  std::unordered_map<BrickName, State, BrickNameHash> bricks_;
  std::size_t bytes_ = 0, computed_ = 0;
  std::uint64_t time_ = 0;
};

}  // namespace gs::qnv::values
