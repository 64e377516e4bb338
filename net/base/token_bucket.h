#pragma once

#include <chrono>
#include <cstdint>

namespace gs::net {

/// Time since some moment that is the same for all who talk of it; never goes
/// back.
using Instant = std::chrono::microseconds;

/// Lets bytes pass at a rate, and after a pause `burst` of them at once. Exact
/// in integers, so that a replay gives the same. Rates of 0 let nothing pass;
/// the highest is 2^33 bytes a second.
class TokenBucket {
 public:
  TokenBucket() = default;
  /// Full at the start.
  TokenBucket(std::uint64_t bytes_per_second, std::uint64_t burst, Instant now);
  /// From now on; what was saved up stays, up to the burst.
  void set_rate(std::uint64_t bytes_per_second, std::uint64_t burst, Instant now);
  [[nodiscard]] std::uint64_t rate() const { return rate_; }
  /// From now on so many bytes may pass before they were saved up; they are paid back at the rate.
  void allow_debt(std::uint64_t bytes);
  /// Whether so many bytes may pass, at most the burst.
  [[nodiscard]] bool has(std::uint64_t bytes, Instant now);
  /// They passed. Debts are allowed and paid back.
  void take(std::uint64_t bytes, Instant now);
  /// When `has` will be true, unless more is taken; Instant::max() for never.
  [[nodiscard]] Instant when(std::uint64_t bytes, Instant now);

 private:
  void fill(Instant now);

  std::uint64_t rate_ = 0, burst_ = 0;
  std::int64_t credit_ = 0;  // millionths of a byte
  std::int64_t debt_ = 0;    // allowed, likewise
  Instant filled_{};
};

}  // namespace gs::net
