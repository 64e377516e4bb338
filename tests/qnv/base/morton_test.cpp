#include "qnv/base/morton.h"

#include <catch2/catch.hpp>

#include <array>
#include <cstdint>
#include <random>

namespace gs::qnv {
namespace {

TEST_CASE("interleaves the bits of x, y and z in Morton codes") {
  STATIC_REQUIRE(morton_encode(0, 0, 0) == 0);
  STATIC_REQUIRE(morton_encode(1, 0, 0) == 1);
  STATIC_REQUIRE(morton_encode(0, 1, 0) == 2);
  STATIC_REQUIRE(morton_encode(0, 0, 1) == 4);
  STATIC_REQUIRE(morton_encode(2, 3, 1) == (0b011 << 3 | 0b110));
  STATIC_REQUIRE(morton_encode(0x1fffff, 0x1fffff, 0x1fffff) == 0x7fffffffffffffffULL);
}

TEST_CASE("decodes Morton codes, whole or one bit at a time") {
  std::mt19937 random(1);
  for (int i = 0; i < 10000; ++i) {
    const auto number = [&random] { return static_cast<std::uint32_t>(random() & 0x1fffff); };
    const std::array<std::uint32_t, 3> cell{number(), number(), number()};
    const std::uint64_t code = morton_encode(cell[0], cell[1], cell[2]);
    REQUIRE(morton_decode(code) == cell);
    std::uint64_t slow = 0;
    for (unsigned bit = 0; bit < 21; ++bit)
      for (unsigned axis = 0; axis < 3; ++axis)
        slow |= static_cast<std::uint64_t>(cell[axis] >> bit & 1) << (3 * bit + axis);
    REQUIRE(code == slow);
    REQUIRE(morton_decode(code >> 3) == std::array<std::uint32_t, 3>{cell[0] / 2, cell[1] / 2, cell[2] / 2});
  }
}

}  // namespace
}  // namespace gs::qnv
