#pragma once

#include <chrono>
#include <cstdint>

namespace gs::net {

/// Time since a fixed moment that all participants share. Never decreases.
using Instant = std::chrono::microseconds;

/// Limits bytes to a rate, with bursts of up to `burst` bytes. Uses integers only, so that replays are exact. A rate of
/// 0 lets nothing pass; the maximum is 2^33 bytes per second.
class TokenBucket {
 public:
  TokenBucket() = default;
  /// Starts full.
  TokenBucket(std::uint64_t bytes_per_second, std::uint64_t burst, Instant now);
  /// Changes rate and burst from now on. Keeps the saved tokens, up to the burst.
  void set_rate(std::uint64_t bytes_per_second, std::uint64_t burst, Instant now);
  [[nodiscard]] std::uint64_t rate() const { return rate_; }
  /// Lets up to `bytes` bytes pass in advance from now on; they are repaid at the rate.
  void allow_debt(std::uint64_t bytes);
  /// Reports whether `bytes` bytes may pass. `bytes` is at most the burst.
  [[nodiscard]] bool has(std::uint64_t bytes, Instant now);
  /// Removes tokens for bytes that have passed. The balance may become negative.
  void take(std::uint64_t bytes, Instant now);
  /// Returns the time at which `has` becomes true if no more is taken; Instant::max() means never.
  [[nodiscard]] Instant when(std::uint64_t bytes, Instant now);

 private:
  void fill(Instant now);

  std::uint64_t rate_ = 0, burst_ = 0;
  std::int64_t credit_ = 0;  // millionths of a byte
  std::int64_t debt_ = 0;    // allowed debt, in millionths of a byte
  Instant filled_{};
};

}  // namespace gs::net
