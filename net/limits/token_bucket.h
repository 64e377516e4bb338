#pragma once

#include <chrono>
#include <cstdint>

namespace gs::net {

/// Microseconds since a fixed moment that all participants share. Never decreases.
using Instant = std::chrono::microseconds;

/// Limits bytes to a rate, with bursts of up to `burst` bytes. A rate of 0 lets no bytes pass; the maximum is 2^33
/// bytes per second. Uses integers only, so that replays are exact.
class TokenBucket {
 public:
  TokenBucket() = default;
  /// Starts with a full bucket.
  TokenBucket(std::uint64_t bytes_per_second, std::uint64_t burst, Instant now);
  /// Changes rate and burst from now on. Keeps the collected tokens, up to the burst.
  void set_rate(std::uint64_t bytes_per_second, std::uint64_t burst, Instant now);
  [[nodiscard]] std::uint64_t rate() const { return rate_; }
  /// Lets the balance fall to minus `bytes` from now on. Later tokens repay the debt at the rate.
  void allow_debt(std::uint64_t bytes);
  /// Reports whether `bytes` bytes may pass now. `bytes` must not exceed the burst.
  [[nodiscard]] bool has(std::uint64_t bytes, Instant now);
  /// Removes tokens for bytes that have passed. May make the balance negative.
  void take(std::uint64_t bytes, Instant now);
  /// Returns the time at which has() becomes true if no tokens are taken before. Instant::max() means never.
  [[nodiscard]] Instant when(std::uint64_t bytes, Instant now);

 private:
  void fill(Instant now);

  std::uint64_t rate_ = 0, burst_ = 0;
  std::int64_t credit_ = 0;  // balance, in millionths of a byte
  std::int64_t debt_ = 0;    // allowed debt, in millionths of a byte
  Instant filled_{};
};

}  // namespace gs::net
