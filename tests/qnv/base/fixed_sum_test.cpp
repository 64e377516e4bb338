#include "qnv/base/fixed_sum.h"

#include "qnv/base/key_table.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

namespace gs::qnv::fixed_sum_test {

TEST_CASE("sums numbers equally in any order and in parts") {
  std::mt19937 random(4);
  std::vector<float> numbers;
  for (int i = 0; i < 2000; ++i)
    numbers.push_back((static_cast<float>(random() % 20001) / 1e4f - 1) * (i % 7 ? 1 : 1e-4f));
  const auto sum_of = [&](std::size_t first, std::size_t end) {
    FixedSum<36> sum;
    for (std::size_t i = first; i < end; ++i) sum.add(numbers[i]);
    return sum;
  };
  double exact = 0;
  for (const float number : numbers) exact += static_cast<double>(number);
  const double forward = sum_of(0, numbers.size()).value();
  CHECK(forward == Approx(exact).margin(1e-7));
  FixedSum<36> parts = sum_of(700, numbers.size());
  parts.add(sum_of(0, 700));
  CHECK(parts.value() == forward);
  std::shuffle(numbers.begin(), numbers.end(), random);
  CHECK(sum_of(0, numbers.size()).value() == forward);
}

TEST_CASE("leaves numbers out of a sum that are too large or not finite") {
  FixedSum<30> sum;
  for (const float number :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -3e38f, 5e9f})
    sum.add(number);
  CHECK(sum.value() == 0);
  sum.add(-2.5f);
  CHECK(sum.value() == -2.5);
}

TEST_CASE("numbers distinct keys in the order of their first use") {
  KeyTable table;
  std::vector<std::uint64_t> keys;
  for (std::uint64_t i = 0; i < 5000; ++i) keys.push_back(i * i << 20);
  for (std::size_t i = 0; i < keys.size(); ++i) REQUIRE(table.add(keys[i]) == i);
  for (std::size_t i = keys.size(); i-- > 0;) REQUIRE(table.add(keys[i]) == i);
  CHECK(table.keys() == keys);
}

}  // namespace gs::qnv::fixed_sum_test
