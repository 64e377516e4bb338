// How exhaustive a loop is in each of the builds that tests run in, and assertions of very many elements.
#pragma once

#include <catch2/catch.hpp>

#include <cstddef>

// A test's object file stands in both variants of its program; which of them runs shows only then.
extern "C" void __asan_init() __attribute__((weak));
extern "C" void __tsan_init() __attribute__((weak));

namespace gs {

/// Whether AddressSanitizer or ThreadSanitizer watches what is tested: they keep what was freed, and terabytes of
/// addresses.
inline bool watched() { return __asan_init != nullptr || __tsan_init != nullptr; }

/// The step of a loop over bits, prefixes, split points or random rounds: 1 in the optimised build, `step` where
/// AddressSanitizer watches each access or a debugger follows (which takes ten times as long and more for the same
/// paths through the code). Odd steps meet every bit of a byte and every alignment.
inline std::size_t watched_step(std::size_t step) {
#ifdef NDEBUG
  return watched() ? step : 1;
#else
  return step;
#endif
}

}  // namespace gs

/// REQUIRE for one of very many elements: Catch2, which takes a microsecond for an assertion and several where every
/// access is watched, hears of those that fail.
#define REQUIRE_EACH(...)                       \
  do {                                          \
    if (!(__VA_ARGS__)) REQUIRE((__VA_ARGS__)); \
  } while (false)
