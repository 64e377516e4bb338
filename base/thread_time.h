#pragma once

#include <time.h>

namespace gs {

/// Returns the processor time of this thread in seconds.
[[nodiscard]] inline double thread_seconds() {
  timespec used{};
  (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &used);
  return static_cast<double>(used.tv_sec) + static_cast<double>(used.tv_nsec) * 1e-9;
}

}  // namespace gs
