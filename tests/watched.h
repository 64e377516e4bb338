// How exhaustive a loop is in each of the two builds that tests run in.
#pragma once

#include <cstddef>

namespace gs {

/// The step of a loop over bits, prefixes, split points or random rounds: 1 in the optimised build, `step` where
/// AddressSanitizer watches each access (which takes tens of times as long for the same paths through the code). Odd
/// steps meet every bit of a byte and every alignment.
constexpr std::size_t watched_step([[maybe_unused]] std::size_t step) {
#ifdef __SANITIZE_ADDRESS__
  return step;
#else
  return 1;
#endif
}

}  // namespace gs
