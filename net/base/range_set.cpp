#include "net/base/range_set.h"

#include <algorithm>

namespace gs::net {
namespace {

/// Returns the first range that ends at or after byte `place`.
auto first_reaching(std::vector<ByteRange>& ranges, std::uint64_t place) {
  return std::lower_bound(ranges.begin(), ranges.end(), place,
                          [](const ByteRange& range, std::uint64_t at) { return range.end < at; });
}

}  // namespace

RangeSet::RangeSet(std::span<const ByteRange> ranges) {
  std::vector<ByteRange> sorted(ranges.begin(), ranges.end());
  std::sort(sorted.begin(), sorted.end(), [](const ByteRange& a, const ByteRange& b) { return a.begin < b.begin; });
  for (const ByteRange& range : sorted) add(range);
}

void RangeSet::add(ByteRange range) {
  if (range.empty()) return;
  const auto first = first_reaching(ranges_, range.begin);
  auto last = first;
  for (; last != ranges_.end() && last->begin <= range.end; ++last) {
    range.begin = std::min(range.begin, last->begin);
    range.end = std::max(range.end, last->end);
  }
  if (first == last) {
    ranges_.insert(first, range);
    return;
  }
  *first = range;
  ranges_.erase(first + 1, last);
}

void RangeSet::subtract(ByteRange range) {
  if (range.empty()) return;
  const auto first = first_reaching(ranges_, range.begin);
  auto last = first;
  ByteRange before, after;
  bool has_before = false, has_after = false;
  for (; last != ranges_.end() && last->begin < range.end; ++last) {
    if (last->begin < range.begin) {
      before = {last->begin, std::min(last->end, range.begin)};
      has_before = true;
    }
    if (last->end > range.end) {
      after = {range.end, last->end};
      has_after = true;
    }
  }
  auto place = ranges_.erase(first, last);
  if (has_after) place = ranges_.insert(place, after);
  if (has_before) ranges_.insert(place, before);
}

bool RangeSet::contains(ByteRange range) const {
  if (range.empty()) return true;
  const auto found =
      std::lower_bound(ranges_.begin(), ranges_.end(), range.end,
                       [](const ByteRange& candidate, std::uint64_t end) { return candidate.end < end; });
  return found != ranges_.end() && found->begin <= range.begin;
}

std::uint64_t RangeSet::size() const {
  std::uint64_t sum = 0;
  for (const ByteRange& range : ranges_) sum += range.size();
  return sum;
}

RangeSet RangeSet::within(ByteRange range) const {
  RangeSet result;
  auto found = std::upper_bound(ranges_.begin(), ranges_.end(), range.begin,
                                [](std::uint64_t at, const ByteRange& candidate) { return at < candidate.end; });
  for (; found != ranges_.end() && found->begin < range.end; ++found) {
    const ByteRange common{std::max(found->begin, range.begin), std::min(found->end, range.end)};
    if (!common.empty()) result.ranges_.push_back(common);
  }
  return result;
}

RangeSet RangeSet::within(const RangeSet& other) const {
  RangeSet result;
  auto a = ranges_.begin();
  auto b = other.ranges_.begin();
  while (a != ranges_.end() && b != other.ranges_.end()) {
    const ByteRange common{std::max(a->begin, b->begin), std::min(a->end, b->end)};
    if (!common.empty()) result.ranges_.push_back(common);
    (a->end < b->end) ? ++a : ++b;
  }
  return result;
}

RangeSet RangeSet::without(const RangeSet& other) const {
  RangeSet result;
  auto b = other.ranges_.begin();
  for (ByteRange rest : ranges_) {
    while (b != other.ranges_.end() && b->end <= rest.begin) ++b;
    for (auto cut = b; cut != other.ranges_.end() && cut->begin < rest.end; ++cut) {
      if (cut->begin > rest.begin) result.ranges_.push_back({rest.begin, cut->begin});
      rest.begin = cut->end;
    }
    if (!rest.empty()) result.ranges_.push_back(rest);
  }
  return result;
}

std::vector<ByteRange> RangeSet::joined(std::uint64_t gap) const {
  std::vector<ByteRange> result;
  for (const ByteRange& range : ranges_)
    if (!result.empty() && range.begin - result.back().end < gap)
      result.back().end = range.end;
    else
      result.push_back(range);
  return result;
}

}  // namespace gs::net
