#include "qnv/mesh/triangle_pipeline.h"

#include <catch2/catch.hpp>

#include <stdexcept>
#include <thread>

namespace gs::qnv::conveyor_test {
namespace {

std::vector<Triangle> numbered(std::size_t first, std::size_t count) {
  std::vector<Triangle> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i].positions[0].x = static_cast<float>(first + i);
  return out;
}

}  // namespace

TEST_CASE("processes all triangles in order on any number of threads") {
  const unsigned threads = GENERATE(0u, 1u, 2u, 5u);
  std::vector<float> seen;
  TrianglePipeline conveyor(
      [&](std::span<const Triangle> some) {
        for (const Triangle& t : some) seen.push_back(t.positions[0].x);
      },
      threads);
  std::size_t sent = 0;
  for (const std::size_t count : {1u, 0u, 4096u, 30'000u, 7u}) {
    REQUIRE(conveyor.put(numbered(sent, count)));
    sent += count;
  }
  for (int i = 0; i < 200; ++i, ++sent) REQUIRE(conveyor.put(numbered(sent, 1)));
  conveyor.finish();
  REQUIRE(seen.size() == sent);
  for (std::size_t i = 0; i < sent; ++i) REQUIRE(seen[i] == static_cast<float>(i));
}

TEST_CASE("rethrows an exception of the work at the end and takes no more triangles") {
  std::size_t done = 0;
  TrianglePipeline conveyor(
      [&](std::span<const Triangle>) {
        if (++done == 3) throw std::runtime_error("third");
      },
      2);
  bool taken = true;
  for (int i = 0; i < 100'000 && taken; ++i) taken = conveyor.put(numbered(0, 1));
  CHECK_FALSE(taken);
  CHECK_THROWS_WITH(conveyor.finish(), "third");
  CHECK(done == 3);
}

TEST_CASE("finishes all its work when it is destroyed without a call") {
  std::size_t done = 0;
  {
    TrianglePipeline conveyor([&](std::span<const Triangle> some) { done += some.size(); }, 2);
    REQUIRE(conveyor.put(numbered(0, 10'000)));
  }
  CHECK(done == 10'000);
}

}  // namespace gs::qnv::conveyor_test
