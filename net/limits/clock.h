#pragma once

#include "net/limits/token_bucket.h"

#include <chrono>

namespace gs::net {

/// Returns the time of the system's steady clock. Any thread.
[[nodiscard]] inline Instant clock_now() {
  return std::chrono::duration_cast<Instant>(std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace gs::net
