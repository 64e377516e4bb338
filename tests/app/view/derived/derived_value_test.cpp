#include "app/view/derived/derived_value.h"

#include "tests/app/view/derived/volume_balls.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <thread>

namespace gs::app::derived_value_test {
namespace {

using Number = DerivedValue<int, int>;
using Made = DerivedContent<int>;

void wait_for(Number& number) {
  for (int i = 0; i < 5000 && number.is_busy(); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    (void)number.take();
  }
  CHECK_FALSE(number.is_busy());
}

Made doubled(const std::shared_ptr<const VolumeGrid>& grid, int wish, Progress&) {
  return std::make_shared<const int>(2 * wish + static_cast<int>(grid->kept(0)));
}

}  // namespace

TEST_CASE("keeps derived content until content of better values is ready") {
  const auto coarse = test_balls::grid_of(test_balls::ball(4)), fine = test_balls::grid_of(test_balls::ball(8));
  Number number;
  CHECK_FALSE(number.get(coarse, 10, doubled));
  CHECK(number.is_busy());
  wait_for(number);
  REQUIRE(number.get(coarse, 10, doubled));
  CHECK(*number.get(coarse, 10, doubled) == 24);
  CHECK_FALSE(number.is_busy());
  CHECK(*number.get(fine, 10, doubled) == 24);
  wait_for(number);
  if (*number.get(fine, 10, doubled) == 24) wait_for(number);  // it rested before
  CHECK(*number.get(fine, 10, doubled) == 28);
}

TEST_CASE("keeps derived content for several viewports with different wishes") {
  const auto grid = test_balls::grid_of(test_balls::ball(4));
  Number number;
  CHECK_FALSE(number.get(grid, 1, doubled));
  wait_for(number);
  for (const int wish : {2, 3, 4}) {
    CHECK(*number.get(grid, wish, doubled) == 2 * (wish - 1) + 4);  // of the wish before, meanwhile
    wait_for(number);
  }
  for (const int wish : {4, 3, 2, 1}) CHECK(*number.get(grid, wish, doubled) == 2 * wish + 4);
  CHECK_FALSE(number.is_busy());
  CHECK(number.get(grid, 5, doubled));
  wait_for(number);
  CHECK(*number.get(grid, 5, doubled) == 14);
  CHECK(*number.get(grid, 4, doubled) == 14);  // the wish that was used least recently is forgotten
  wait_for(number);
  CHECK(*number.get(grid, 4, doubled) == 12);
}

TEST_CASE("reports the problem of derived content, and tries again with better values") {
  const auto coarse = test_balls::grid_of(test_balls::ball(4)), fine = test_balls::grid_of(test_balls::ball(8));
  Number number;
  int calls = 0;
  const auto make = [&calls, &coarse](const auto& grid, int wish, Progress& progress) -> Made {
    ++calls;
    if (grid == coarse) return std::string("too coarse");
    return doubled(grid, wish, progress);
  };
  CHECK_FALSE(number.get(coarse, 1, make));
  wait_for(number);
  CHECK_FALSE(number.get(coarse, 1, make));
  CHECK(number.problem() == "too coarse");
  CHECK_FALSE(number.is_busy());
  CHECK(calls == 1);
  CHECK_FALSE(number.get(fine, 1, make));
  wait_for(number);
  CHECK(*number.get(fine, 1, make) == 10);
  CHECK(number.problem().empty());
}

TEST_CASE("cancels a long computation when it is no longer wished") {
  const auto grid = test_balls::grid_of(test_balls::ball(4));
  std::atomic<bool> cancelled{false};
  const auto endless = [&cancelled](const auto&, int, Progress& progress) -> Made {
    while (!progress.cancelled) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    cancelled = true;
    return std::string("cancelled");
  };
  {
    Number number;
    CHECK_FALSE(number.get(grid, 1, endless));
    CHECK_FALSE(number.get(grid, 2, doubled));
    CHECK_FALSE(cancelled);
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    CHECK_FALSE(number.get(grid, 2, doubled));
    wait_for(number);
    CHECK(cancelled);
    CHECK_FALSE(number.get(grid, 2, doubled));
    wait_for(number);
    CHECK(*number.get(grid, 2, doubled) == 8);
    cancelled = false;
    (void)number.get(grid, 3, endless);
  }
  CHECK(cancelled);  // by the destructor
}

}  // namespace gs::app::derived_value_test
