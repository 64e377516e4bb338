#include "net/base/range_set.h"

#include <catch2/catch.hpp>

#include <array>
#include <bitset>
#include <random>

namespace {

using gs::net::ByteRange;
using gs::net::kOpenEnd;
using gs::net::RangeSet;

std::vector<ByteRange> listed(const RangeSet& set) { return {set.ranges().begin(), set.ranges().end()}; }

TEST_CASE("joins ranges that touch or overlap") {
  RangeSet set;
  set.add({10, 20});
  set.add({30, 40});
  set.add({20, 25});
  CHECK(listed(set) == std::vector<ByteRange>{{10, 25}, {30, 40}});
  set.add({5, 5});
  CHECK(listed(set).size() == 2);
  set.add({24, 31});
  CHECK(listed(set) == std::vector<ByteRange>{{10, 40}});
  set.subtract({15, 20});
  CHECK(listed(set) == std::vector<ByteRange>{{10, 15}, {20, 40}});
  CHECK(set.size() == 25);
  CHECK(set.contains({20, 40}));
  CHECK(set.contains({12, 12}));
  CHECK_FALSE(set.contains({14, 21}));
}

TEST_CASE("handles ranges with an open end") {
  RangeSet set(std::array{ByteRange{}});
  CHECK(set.size() == kOpenEnd);
  set.subtract({0, 100});
  CHECK(listed(set) == std::vector<ByteRange>{{100, kOpenEnd}});
  CHECK(listed(set.within(ByteRange{50, 200})) == std::vector<ByteRange>{{100, 200}});
  CHECK(set.contains({1000, kOpenEnd}));
}

TEST_CASE("closes small gaps when it joins ranges") {
  const RangeSet set(std::array{ByteRange{0, 10}, ByteRange{13, 20}, ByteRange{24, 30}});
  CHECK(set.joined(4) == std::vector<ByteRange>{{0, 20}, {24, 30}});
  CHECK(set.joined(5) == std::vector<ByteRange>{{0, 30}});
  CHECK(set.joined(0) == listed(set));
}

TEST_CASE("gives the same results as sets of single bytes") {
  constexpr std::size_t kBytes = 48;
  std::mt19937 random(7);
  const auto bits = [](const RangeSet& set) {
    std::bitset<kBytes> result;
    std::uint64_t behind = 0;
    for (const ByteRange& range : set.ranges()) {
      REQUIRE_FALSE(range.empty());
      REQUIRE((behind == 0 || range.begin > behind));
      behind = range.end;
      for (std::uint64_t i = range.begin; i < range.end; ++i) result.set(i);
    }
    return result;
  };
  for (int round = 0; round < 200; ++round) {
    std::array<RangeSet, 2> sets;
    std::array<std::bitset<kBytes>, 2> expected;
    for (int step = 0; step < 24; ++step) {
      const std::size_t which = random() % 2, begin = random() % kBytes, end = begin + random() % (kBytes - begin);
      const bool adds = random() % 3 > 0;
      adds ? sets[which].add({begin, end}) : sets[which].subtract({begin, end});
      for (std::size_t i = begin; i < end; ++i) expected[which][i] = adds;
      REQUIRE(bits(sets[which]) == expected[which]);
    }
    REQUIRE(bits(sets[0].within(sets[1])) == (expected[0] & expected[1]));
    REQUIRE(bits(sets[0].without(sets[1])) == (expected[0] & ~expected[1]));
    REQUIRE(sets[0].size() == expected[0].count());
    const std::size_t begin = random() % kBytes, end = begin + random() % (kBytes - begin);
    bool all = true;
    for (std::size_t i = begin; i < end; ++i) all &= expected[0][i];
    REQUIRE(sets[0].contains({begin, end}) == all);
  }
}

}  // namespace
