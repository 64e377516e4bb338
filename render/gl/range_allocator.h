#pragma once

#include <cstddef>
#include <iterator>
#include <map>
#include <optional>

namespace gs::render {

/// Allocates ranges of [0, capacity), first fit. Merges adjacent free ranges.
class RangeAllocator {
 public:
  explicit RangeAllocator(std::size_t capacity) {
    if (capacity > 0) free_.emplace(0, capacity);
  }

  /// Takes a free range of `size` (more than 0) and returns its start. Returns nullopt if no free range is large
  /// enough.
  [[nodiscard]] std::optional<std::size_t> take(std::size_t size) {
    for (auto range = free_.begin(); range != free_.end(); ++range) {
      if (range->second < size) continue;
      const std::size_t start = range->first, left = range->second - size;
      free_.erase(range);
      if (left > 0) free_.emplace(start + size, left);
      return start;
    }
    return std::nullopt;
  }

  /// Frees a range that `take(size)` returned.
  void give_back(std::size_t start, std::size_t size) {
    auto range = free_.emplace(start, size).first;
    const auto next = std::next(range);
    if (next != free_.end() && range->first + range->second == next->first) {
      range->second += next->second;
      free_.erase(next);
    }
    if (range == free_.begin()) return;
    const auto previous = std::prev(range);
    if (previous->first + previous->second == range->first) {
      previous->second += range->second;
      free_.erase(range);
    }
  }

 private:
  std::map<std::size_t, std::size_t> free_;  // start and size of each free range
};

}  // namespace gs::render
