#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace gs::net {

/// End of a range that extends to the end of a resource with unknown length.
constexpr std::uint64_t kOpenEnd = std::numeric_limits<std::uint64_t>::max();

/// Bytes from `begin` to before `end` of a resource.
struct ByteRange {
  std::uint64_t begin = 0;
  std::uint64_t end = kOpenEnd;

  [[nodiscard]] bool empty() const { return begin >= end; }
  [[nodiscard]] std::uint64_t size() const { return empty() ? 0 : end - begin; }
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// Set of byte positions, stored as sorted ranges that neither overlap nor touch. Copyable. One thread.
class RangeSet {
 public:
  RangeSet() = default;
  explicit RangeSet(std::span<const ByteRange> ranges);

  /// Adds a range. Empty ranges have no effect.
  void add(ByteRange range);
  void subtract(ByteRange range);
  void clear() { ranges_.clear(); }

  [[nodiscard]] bool empty() const { return ranges_.empty(); }
  [[nodiscard]] bool contains(ByteRange range) const;
  /// Returns the number of bytes. For a set with an open end, returns kOpenEnd minus the first byte.
  [[nodiscard]] std::uint64_t size() const;
  [[nodiscard]] std::span<const ByteRange> ranges() const { return ranges_; }

  /// Returns the bytes of this set that are in `range`.
  [[nodiscard]] RangeSet within(ByteRange range) const;
  [[nodiscard]] RangeSet within(const RangeSet& other) const;
  /// Returns the bytes of this set that are not in `other`.
  [[nodiscard]] RangeSet without(const RangeSet& other) const;
  /// Returns the ranges, and closes gaps of fewer than `gap` bytes. A few unneeded bytes cost less than another
  /// request.
  [[nodiscard]] std::vector<ByteRange> joined(std::uint64_t gap) const;

  friend bool operator==(const RangeSet&, const RangeSet&) = default;

 private:
  std::vector<ByteRange> ranges_;
};

}  // namespace gs::net
