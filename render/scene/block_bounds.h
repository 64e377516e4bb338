#pragma once

#include "base/box.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace gs::render {

/// Bounds of many items, in blocks of successive items, so that a change of an item costs only its block.
class BlockBounds {
 public:
  /// Discards all bounds, for a new number of items.
  void reset(std::size_t items) {
    items_ = items;
    const std::size_t blocks = (items + kBlock - 1) / kBlock;
    bounds_.assign(blocks, {});
    stale_.clear();
    is_stale_.assign(blocks, false);
  }
  /// Adds the bounds of an item after reset().
  void add(std::size_t item, const WideBox& bounds) { bounds_[item / kBlock].add(bounds); }
  /// Notes that the bounds of an item have changed.
  void note_change(std::size_t item) {
    const std::size_t block = item / kBlock;
    if (is_stale_[block]) return;
    is_stale_[block] = true;
    stale_.push_back(block);
  }
  [[nodiscard]] bool has_changes() const { return !stale_.empty(); }
  /// Computes the changed blocks again. `bounds_of(item)` returns a pointer to the bounds; null means none.
  template <class BoundsOf>
  void renew(const BoundsOf& bounds_of) {
    for (const std::size_t block : stale_) {
      is_stale_[block] = false;
      WideBox& sum = bounds_[block] = {};
      const std::size_t end = std::min(items_, (block + 1) * kBlock);
      for (std::size_t i = block * kBlock; i < end; ++i)
        if (const WideBox* one = bounds_of(i)) sum.add(*one);
    }
    stale_.clear();
  }
  /// Returns the bounds of all items.
  [[nodiscard]] WideBox sum() const {
    WideBox sum;
    for (const WideBox& block : bounds_)
      if (!block.empty()) sum.add(block);
    return sum;
  }

 private:
  static constexpr std::size_t kBlock = 256;
  std::vector<WideBox> bounds_;
  std::vector<std::size_t> stale_;
  std::vector<bool> is_stale_;
  std::size_t items_ = 0;
};

}  // namespace gs::render
