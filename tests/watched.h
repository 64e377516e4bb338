// How exhaustive a loop is in each of the builds that tests run in, and assertions of very many elements.
#pragma once

#include <catch2/catch.hpp>

#include <cstddef>

namespace gs {

/// The step of a loop over bits, prefixes, split points or random rounds: 1 in the optimised build, `step` where
/// AddressSanitizer watches each access or a debugger follows (which takes ten times as long and more for the same
/// paths through the code). Odd steps meet every bit of a byte and every alignment.
constexpr std::size_t watched_step([[maybe_unused]] std::size_t step) {
#ifdef NDEBUG
  return 1;
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
