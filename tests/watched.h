// Helpers for long loops in tests: their step under sanitizers, and assertions for very many elements.
#pragma once

#include <catch2/catch.hpp>

#include <cstddef>

// Both variants of a test program contain the same object files. These symbols show at run time which variant runs.
extern "C" void __asan_init() __attribute__((weak));
extern "C" void __tsan_init() __attribute__((weak));

namespace gs {

/// Reports whether AddressSanitizer or ThreadSanitizer runs. They keep freed memory, and reserve terabytes of
/// addresses.
inline bool watched() { return __asan_init != nullptr || __tsan_init != nullptr; }

/// Returns the step of a loop over bits, prefixes, split points or random rounds. This is 1 in the optimised build, and
/// `step` with sanitizers or in a debug build, which take at least ten times as long. An odd step reaches every bit of
/// a byte and every alignment.
inline std::size_t watched_step(std::size_t step) {
#ifdef NDEBUG
  return watched() ? step : 1;
#else
  return step;
#endif
}

}  // namespace gs

/// REQUIRE for one of very many elements. Passes only failures to Catch2, which takes at least a microsecond per
/// assertion.
#define REQUIRE_EACH(...)                       \
  do {                                          \
    if (!(__VA_ARGS__)) REQUIRE((__VA_ARGS__)); \
  } while (false)
