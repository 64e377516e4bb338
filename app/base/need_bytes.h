#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

// Uses the standard library only, because the module for scientific formats includes it.
namespace gs::app {

/// Consecutive bytes of a file.
struct ByteSpan {
  std::uint64_t offset = 0, bytes = 0;
  friend bool operator==(const ByteSpan&, const ByteSpan&) = default;
};

/// Function that receives parts of a file from a server, all of them at once. Bytes that were not received read as
/// zeros. Returns false if a part cannot be received. Null means that the whole file is readable.
using NeedBytes = std::function<bool(std::span<const ByteSpan> parts)>;

/// Makes a part of a file readable. Returns false on failure.
[[nodiscard]] inline bool have_bytes(const NeedBytes& need, std::uint64_t offset, std::uint64_t bytes) {
  const ByteSpan part{offset, bytes};
  return !need || need({&part, 1});
}

/// Collector of parts of a file, which makes many of them readable at once. Their offsets should ascend.
class NeededParts {
 public:
  explicit NeededParts(const NeedBytes& need) : need_(need) {}

  /// Adds a part, or extends the previous part if the gap is short. Returns false if parts cannot be read.
  [[nodiscard]] bool add(std::uint64_t offset, std::uint64_t bytes) {
    constexpr std::uint64_t kShortGap = 4096;
    constexpr std::size_t kMostTogether = 4096;
    if (!need_ || bytes == 0) return true;
    if (!parts_.empty()) {
      ByteSpan& last = parts_.back();
      const std::uint64_t end = last.offset + last.bytes;
      if (offset >= last.offset && (offset <= end || offset - end <= kShortGap)) {
        last.bytes = std::max(end, offset + bytes) - last.offset;
        return true;
      }
    }
    if (parts_.size() == kMostTogether && !finish()) return false;
    parts_.push_back({offset, bytes});
    return true;
  }
  /// Makes the remaining added parts readable. Returns false on failure.
  [[nodiscard]] bool finish() {
    const bool good = parts_.empty() || need_(parts_);
    parts_.clear();
    return good;
  }

  /// Adds a box of an array. `steps` are the distances in bytes between neighbouring elements along each axis. `count`
  /// is the size of the box. Both begin with the slowest axis. Elements of the last axis are `element` bytes apart.
  [[nodiscard]] bool add_box(std::uint64_t begin, std::span<const std::uint64_t> steps,
                             std::span<const std::uint64_t> count, std::uint64_t element) {
    if (!need_) return true;
    // Joins the innermost axes without gaps into runs.
    std::size_t outer = count.size();
    std::uint64_t run = element;
    while (outer > 0 && steps[outer - 1] == run) run *= count[--outer];
    std::vector<std::uint64_t> index(outer, 0);
    for (;;) {
      if (!add(begin, run)) return false;
      std::size_t axis = outer;
      for (; axis > 0; --axis) {
        begin += steps[axis - 1];
        if (++index[axis - 1] < count[axis - 1]) break;
        begin -= steps[axis - 1] * count[axis - 1];
        index[axis - 1] = 0;
      }
      if (axis == 0) return true;
    }
  }

 private:
  const NeedBytes& need_;
  std::vector<ByteSpan> parts_;
};

}  // namespace gs::app
