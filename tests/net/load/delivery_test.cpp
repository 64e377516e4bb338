#include "net/load/delivery.h"

#include <catch2/catch.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace gs::net::delivery_test {

std::vector<LoadData> data_of(LoadQueue& queue) {
  std::vector<LoadData> result;
  for (LoadEvent& event : queue.poll(1 << 20))
    if (auto* const data = std::get_if<LoadData>(&event.what)) result.push_back(std::move(*data));
  return result;
}

TEST_CASE("pushes each needed byte of overlapping responses once") {
  LoadQueue queue(1 << 20, 1 << 20, [] {});
  queue.open({1}, 0);
  queue.push_head({1}, {});
  Request request;
  request.ranges = {{2, 4}, {6, 8}};
  Delivery delivery(queue, {1}, request);
  delivery.begin();
  CHECK_FALSE(delivery.whole());
  constexpr std::array<std::byte, 8> kBytes{std::byte{0}, std::byte{1}, std::byte{2}, std::byte{3},
                                            std::byte{4}, std::byte{5}, std::byte{6}, std::byte{7}};
  CHECK(delivery.push(0, std::span(kBytes).first(7)));
  CHECK_FALSE(delivery.push(0, std::span(kBytes).first(7)));
  CHECK(delivery.push(0, kBytes));
  CHECK(delivery.needed().empty());
  CHECK(delivery.received() == 4);
  std::vector<std::uint64_t> offsets;
  for (const LoadData& data : data_of(queue)) {
    offsets.push_back(data.offset);
    CHECK(data.bytes.front() == kBytes[data.offset]);
  }
  CHECK(offsets == std::vector<std::uint64_t>{2, 6, 7});
}

TEST_CASE("limits a delivery to the size of the resource and to the limit of the request") {
  LoadQueue queue(1 << 20, 1 << 20, [] {});
  Request request;
  request.max_bytes = 10;
  Delivery whole(queue, {1}, request);
  whole.begin();
  CHECK(whole.exceeds_limit({0, 11}));
  CHECK_FALSE(whole.exceeds_limit({0, 10}));
  CHECK_FALSE(whole.limit_to(10));
  CHECK(whole.needed().size() == 10);
  const auto large = whole.limit_to(9);
  CHECK_FALSE(large);
  whole.begin();
  REQUIRE(whole.limit_to(11));
  CHECK(whole.limit_to(11)->kind == LoadErrorKind::too_large);
  request.ranges = {{12, 14}};
  Delivery ranges(queue, {1}, request);
  ranges.begin();
  REQUIRE(ranges.limit_to(12));
  CHECK(ranges.limit_to(12)->message == "byte 12 was requested; it has 12 bytes");
}

}  // namespace gs::net::delivery_test
