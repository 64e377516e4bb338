// How exhaustive a loop is in each of the builds that tests run in.
#pragma once

#include <cstddef>

namespace gs {

/// The step of a loop over bits, prefixes, split points or random rounds: 1 in the optimised build, `step` where
/// AddressSanitizer watches each access or a debugger follows (which takes ten times as long and more for the same paths
/// through the code). Odd steps meet every bit of a byte and every alignment.
constexpr std::size_t watched_step([[maybe_unused]] std::size_t step) {
#ifdef NDEBUG
  return 1;
#else
  return step;
#endif
}

}  // namespace gs
