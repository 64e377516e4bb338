#include "render/sorting/depth_sort.h"

#include "tests/render/geometry_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

using namespace gs;
using namespace gs::test;
using render::far_first_key;
using render::sort_by_key;
using render::DepthSorter;
using render::SortPart;

namespace {

constexpr std::uint64_t entry(std::uint32_t key, std::uint32_t value) { return std::uint64_t{key} << 32 | value; }

/// Returns the depth row of a view from +z, or turned by `angle` about y.
glm::vec4 row(float angle, float distance = 5) { return {-std::sin(angle), 0, -std::cos(angle), distance}; }

std::shared_ptr<const qnv::Volume> points(std::size_t count, unsigned seed) {
  auto geometry = std::make_shared<qnv::Volume>();
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> part(-1, 1);
  for (std::size_t i = 0; i < count; ++i) add(*geometry, {part(random), part(random), part(random)}, {0, 0, 1}, 1);
  return geometry;
}

float depth_of(const SortPart& part, std::size_t k) {
  return glm::dot(part.row, glm::vec4(part.vectors->positions[k], 1));
}

/// Checks that an order is by depth, farthest first, with each vector once.
bool sorted(const DepthSorter::Order& order, const SortPart& part) {
  std::vector<bool> seen(part.count);
  float last = kInfinity;
  for (const std::uint32_t k : order.far_first) {
    if (k >= part.count || seen[k]) return false;
    seen[k] = true;
    const float depth = depth_of(part, k);
    if (depth > last + 1e-6f) return false;
    last = depth;
  }
  return order.far_first.size() == part.count;
}

}  // namespace

TEST_CASE("makes sort keys that ascend from the farthest to the nearest depth") {
  constexpr std::array<float, 11> depths = {kInfinity, 3e38f,   7,  2.0000002f, 2,         1e-40f,
                                            0,         -1e-40f, -1, -3e38f,     -kInfinity};
  for (std::size_t i = 1; i < depths.size(); ++i) CHECK(far_first_key(depths[i - 1]) < far_first_key(depths[i]));
  CHECK(far_first_key(0.0f) == far_first_key(-0.0f));
  CHECK(far_first_key(kNaN) == 0xFFFFFFFFu);
  CHECK(far_first_key(-kNaN) == 0xFFFFFFFFu);
  CHECK(far_first_key(-kInfinity) < far_first_key(kNaN));
}

TEST_CASE("sorts entries by key, and keeps the order of equal keys") {
  std::mt19937 random(3);
  for (const std::size_t count : {0u, 1u, 2u, 3u, 100u, 5000u, 70'000u}) {
    for (const std::uint32_t mask : {0u, 0xFu, 0xF800000u, 0xFFFFFFFFu}) {
      std::vector<std::uint64_t> entries, room(count / 3, 7);
      for (std::uint32_t i = 0; i < count; ++i)
        entries.push_back(entry(static_cast<std::uint32_t>(random()) & mask, i));
      std::vector<std::uint64_t> wanted = entries;
      // Values ascend, so an order by key and value equals the stable order by key.
      std::sort(wanted.begin(), wanted.end());
      sort_by_key(entries, room);
      CHECK(entries == wanted);
    }
  }
  std::vector<std::uint64_t> entries{entry(5, 9), entry(5, 2), entry(1, 4), entry(5, 1)}, room;
  sort_by_key(entries, room);
  CHECK(entries == std::vector<std::uint64_t>{entry(1, 4), entry(5, 9), entry(5, 2), entry(5, 1)});
}

TEST_CASE("orders the vectors of several volumes together, at one depth the later volume first") {
  auto geometry = std::make_shared<qnv::Volume>();
  for (const float z : {0.0f, 1.0f, 0.0f, -2.0f}) add(*geometry, {0, 0, z}, {0, 0, 1}, 1);
  auto other = std::make_shared<qnv::Volume>();
  for (const float z : {1.0f, kNaN, kInfinity}) add(*other, {0, 0, z}, {0, 0, 1}, 1);
  DepthSorter sorter;
  const std::array<SortPart, 2> parts{{{geometry, 4, row(0)}, {other, 3, {0, 0, -1, 6}}}};
  // The depths are 5 4 5 7 and 5 NaN -infinity.
  const auto order = sorter.order(parts);
  CHECK(order.exact);
  CHECK(std::vector(order.far_first.begin(), order.far_first.end()) == std::vector<std::uint32_t>{3, 4, 2, 0, 1, 6, 5});
  const SortPart first{geometry, 1, row(0)};
  const auto one = sorter.order(std::span(&first, 1));
  CHECK(one.exact);
  REQUIRE(one.far_first.size() == 1);
  CHECK(one.far_first[0] == 0);
  const SortPart none{geometry, 0, row(0)};
  CHECK(sorter.order(std::span(&none, 1)).far_first.empty());
  CHECK(sorter.order({}).exact);
}

TEST_CASE("sorts at most one view late, and exactly for an unchanged view") {
  const auto geometry = points(50'000, 1);
  DepthSorter sorter;
  SortPart last{geometry, geometry->size(), row(0)};
  auto order = sorter.order(std::span(&last, 1));
  CHECK(order.exact);  // the first order is exact
  CHECK(sorted(order, last));
  for (int frame = 1; frame < 40; ++frame) {
    const SortPart part{geometry, geometry->size(), row(0.02f * static_cast<float>(frame))};
    order = sorter.order(std::span(&part, 1));
    CHECK(sorted(order, order.exact ? part : last));
    last = part;
  }
  // A second request waits at most for its own order.
  order = sorter.order(std::span(&last, 1));
  CHECK(order.exact);
  CHECK(sorted(order, last));
  const std::uint64_t number = order.number;
  order = sorter.order(std::span(&last, 1));
  CHECK(order.number == number);
}

TEST_CASE("waits for the order after large turns, other counts and other volumes") {
  const auto geometry = points(30'000, 2), other = points(30'000, 3);
  DepthSorter sorter;
  const std::array<SortPart, 6> views{{{geometry, 30'000, row(0)},
                                             {geometry, 30'000, row(3)},
                                             {geometry, 30'000, row(2.8f)},
                                             {geometry, 20'000, row(2.8f)},
                                             {other, 20'000, row(2.8f)},
                                             {geometry, 20'000, {0, 0, 0, 1}}}};
  for (const SortPart& view : views) {
    const auto order = sorter.order(std::span(&view, 1));
    CHECK(order.exact);
    CHECK(sorted(order, view));
  }
  const SortPart broken{geometry, 20'000, glm::vec4(kNaN)};
  CHECK(sorter.order(std::span(&broken, 1)).far_first.size() == 20'000);
}

TEST_CASE("releases volumes, and stops during a sort") {
  auto geometry = points(200'000, 4);
  const std::weak_ptr<const qnv::Volume> watched = geometry;
  for (int i = 0; i < 5; ++i) {
    DepthSorter sorter;
    std::array<SortPart, 1> part{{{geometry, geometry->size(), row(0)}}};
    (void)sorter.order(part);
    part[0].row = row(0.01f);
    (void)sorter.order(part);
  }
  geometry.reset();
  CHECK(watched.expired());
}
