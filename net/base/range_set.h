#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace gs::net {

/// The end of a range that reaches to the end of a resource of unknown length.
constexpr std::uint64_t kOpenEnd = std::numeric_limits<std::uint64_t>::max();

/// Bytes `begin` to `end` of a resource, `end` not among them.
struct ByteRange {
  std::uint64_t begin = 0;
  std::uint64_t end = kOpenEnd;

  [[nodiscard]] bool empty() const { return begin >= end; }
  [[nodiscard]] std::uint64_t size() const { return empty() ? 0 : end - begin; }
  friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

/// A set of bytes as sorted ranges of which no two overlap or touch. A value; not safe to share between threads.
class RangeSet {
 public:
  RangeSet() = default;
  explicit RangeSet(std::span<const ByteRange> ranges);

  /// Empty ranges change nothing.
  void add(ByteRange range);
  void subtract(ByteRange range);
  void clear() { ranges_.clear(); }

  [[nodiscard]] bool empty() const { return ranges_.empty(); }
  [[nodiscard]] bool contains(ByteRange range) const;
  /// How many bytes; kOpenEnd minus the first byte for a set with an open end.
  [[nodiscard]] std::uint64_t size() const;
  [[nodiscard]] std::span<const ByteRange> ranges() const { return ranges_; }

  /// What both have.
  [[nodiscard]] RangeSet within(ByteRange range) const;
  [[nodiscard]] RangeSet within(const RangeSet& other) const;
  /// What `other` has not.
  [[nodiscard]] RangeSet without(const RangeSet& other) const;
  /// The same with every gap of fewer than `gap` bytes closed: asking for a few bytes too many is cheaper than asking
  /// once more.
  [[nodiscard]] std::vector<ByteRange> joined(std::uint64_t gap) const;

  friend bool operator==(const RangeSet&, const RangeSet&) = default;

 private:
  std::vector<ByteRange> ranges_;
};

}  // namespace gs::net
