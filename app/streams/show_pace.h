#pragma once

#include "net/limits/token_bucket.h"

#include <algorithm>

namespace gs::app {

/// Pace of the pictures of a growing stream: at most one per quarter of a second, and at most a fifth of the time for
/// making them.
class ShowPace {
 public:
  static constexpr net::Instant kLeast{250'000};

  /// Reports whether the next picture is due. The first one always is.
  [[nodiscard]] bool due(net::Instant now) const { return now >= next_; }
  /// Notes that a picture was made from `began` to `ended`.
  void made(net::Instant began, net::Instant ended) {
    next_ = std::max(began + kLeast, ended + 4 * std::max(ended - began, net::Instant{}));
  }

 private:
  net::Instant next_{};
};

}  // namespace gs::app
