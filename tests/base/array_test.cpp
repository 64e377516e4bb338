#include "base/array.h"

#include <catch2/catch.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace gs::array_test {

TEST_CASE("keeps the capacity below twice the size of a list that is copied before each addition") {
  Array<std::int32_t> list;
  Array<std::string> texts;
  for (int i = 0; i < 200; ++i) {
    Array<std::int32_t> copy = list;
    const std::vector<std::int32_t> more = {i, -i};
    if (i % 2 == 0)
      copy.push_back(i);
    else
      copy.append(more);
    list = copy;
    Array<std::string> other = texts;
    other.push_back(std::to_string(i));
    texts = other;
    CHECK(list.capacity() <= 4 + 2 * list.size());
    CHECK(texts.capacity() <= 4 + 2 * texts.size());
  }
  REQUIRE(list.size() == 300);
  CHECK(list.span()[299] == -199);
  CHECK(texts.span()[199] == "199");
}

TEST_CASE("doubles the capacity of an unshared list, so that its elements move rarely") {
  Array<std::int32_t> list;
  std::size_t moves = 0;
  for (int i = 0; i < 100'000; ++i) {
    const std::size_t before = list.capacity();
    list.push_back(i);
    if (list.capacity() != before) ++moves;
  }
  CHECK(moves < 20);
  CHECK(list.span()[99'999] == 99'999);
}

}  // namespace gs::array_test
