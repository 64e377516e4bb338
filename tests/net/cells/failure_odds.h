#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace gs::net {

/// Returns the probability that fewer than `source` of `symbols` symbols are received. Slow, but simple.
inline double failure_of(std::size_t source, std::size_t symbols, double loss) {
  if (loss <= 0) return symbols < source ? 1 : 0;
  if (loss >= 1) return 1;
  // Sum the binomial distribution from 0 to k - 1 received symbols, by logarithms.
  double sum = 0;
  for (std::size_t arrived = 0; arrived < std::min(source, symbols + 1); ++arrived) {
    const auto n = static_cast<double>(symbols), i = static_cast<double>(arrived);
    sum += std::exp(std::lgamma(n + 1) - std::lgamma(i + 1) - std::lgamma(n - i + 1) + i * std::log(1 - loss) +
                    (n - i) * std::log(loss));
  }
  return std::min(sum, 1.0);
}

}  // namespace gs::net
