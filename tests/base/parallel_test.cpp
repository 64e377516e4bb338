#include "base/parallel.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

namespace gs::parallel_test {

TEST_CASE("calls each index once, also in loops inside of loops and from several threads") {
  std::vector<std::thread> callers;
  std::atomic<int> wrong{0};
  for (int caller = 0; caller < 4; ++caller)
    callers.emplace_back([&] {
      for (int round = 0; round < 50; ++round) {
        std::vector<std::atomic<int>> calls(40);
        parallel_for(
            8, [&](std::size_t outer) { parallel_for(5, [&](std::size_t inner) { ++calls[outer * 5 + inner]; }); });
        for (const auto& count : calls)
          if (count != 1) ++wrong;
      }
    });
  for (std::thread& caller : callers) caller.join();
  CHECK(wrong == 0);
}

TEST_CASE("runs as many calls at a time as the caller states") {
  for (int round = 0; round < 20; ++round) {
    // Each call waits for all others, so fewer threads would never end.
    std::atomic<unsigned> running{0};
    constexpr unsigned kThreads = 6;
    parallel_for(
        kThreads,
        [&](std::size_t) {
          ++running;
          while (running < kThreads) std::this_thread::yield();
        },
        kThreads);
    CHECK(running == kThreads);
  }
}

TEST_CASE("rethrows an exception of a call after all threads have left the loop") {
  for (int round = 0; round < 50; ++round) {
    std::atomic<int> inside{0};
    CHECK_THROWS_AS(parallel_for(
                        100,
                        [&](std::size_t i) {
                          ++inside;
                          if (i == 7) {
                            --inside;
                            throw std::runtime_error("seven");
                          }
                          std::this_thread::sleep_for(std::chrono::microseconds(5));
                          --inside;
                        },
                        3),
                    std::runtime_error);
    CHECK(inside == 0);
  }
}

TEST_CASE("stops soon after a cancellation, and counts the calls") {
  Progress progress;
  std::atomic<int> calls{0};
  CHECK_FALSE(parallel_for(
      1'000'000,
      [&](std::size_t) {
        if (++calls == 10) progress.cancelled = true;
      },
      4, &progress));
  CHECK(calls < 1'000'000);
  CHECK(progress.done == static_cast<std::uint64_t>(calls));
  Progress whole;
  CHECK(parallel_for(
      100, [](std::size_t) {}, 0, &whole));
  CHECK(whole.done == 100);
}

}  // namespace gs::parallel_test
