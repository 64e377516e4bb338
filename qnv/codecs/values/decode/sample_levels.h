#pragma once

#include "qnv/codecs/values/block.h"
#include "qnv/codecs/values/decode/sample_bricks.h"
#include "qnv/container/step_table.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace gs::qnv::values {

/// Blocks of one number that are added: one, or those of consecutive steps of a time series.
class BlockChain {
 public:
  void push(const Block* block) {
    if (count_ < blocks_.size()) blocks_[count_++] = block;
  }
  [[nodiscard]] const Block* const* begin() const { return blocks_.data(); }
  [[nodiscard]] const Block* const* end() const { return blocks_.data() + count_; }

 private:
  std::array<const Block*, kChainSteps> blocks_{};
  std::size_t count_ = 0;
};

/// Samples of all levels of a volume from a coarse one to that which is shown. After changes of some coefficients,
/// repeats the inverse lifting only for the samples that they reach. The result has the same bits as restore().
class SampleLevels {
 public:
  /// Returns the blocks with this number. Their coefficients are added. Any thread may call it.
  using FindBlocks = std::function<BlockChain(std::uint64_t number)>;

  SampleLevels(Extent extent, int levels);

  /// Notes that cubes `first` to `first + steps - 1` of a block were decoded. The cubes after the last one are the
  /// first ones again.
  void note(const Block& block, std::size_t first, std::size_t steps);
  /// Computes the samples of a level.
  void update(int level, const BlockLayout& layout, const FindBlocks& find);
  /// Returns the samples of a level as they were at its last update. They never change.
  [[nodiscard]] SampleBricks copy(int level);
  /// Returns boxes with all samples of a level that changed before its last update, and since the last call.
  [[nodiscard]] std::vector<SampleBox> take(int level);

  /// Edge of the units of changes, in samples.
  static constexpr std::uint32_t kUnit = 4;

 private:
  struct Level {
    SampleBricks samples;
    UnitMask old, changed;  // samples to compute again; samples that changed
    bool begun = false;     // the samples and sets exist
  };
  void begin(int level);
  [[nodiscard]] Level& level_of(int level) { return all_[static_cast<std::size_t>(level)]; }
  void update_top(const BlockChain& blocks);
  void lift_box(int level, const SampleBox& box, const BlockLayout& layout, const FindBlocks& find);

  Extent extent_;
  int levels_;
  std::vector<Level> all_;  // by level; 0 is the volume
};

}  // namespace gs::qnv::values
