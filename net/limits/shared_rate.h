#pragma once

#include "net/limits/token_bucket.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <utility>

namespace gs::net {

/// Rate limit that all transfers of one thread share. `set` may be called on any thread; it takes effect in follow().
class SharedRate {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// A rate of 0 means unlimited.
  explicit SharedRate(std::uint64_t bytes_per_second) : asked_(bytes_per_second) {}
  void set(std::uint64_t bytes_per_second) { asked_ = bytes_per_second; }
  void follow(TimePoint now) {
    const std::uint64_t rate = asked_;
    if (rate == std::exchange(followed_, rate)) return;
    const std::uint64_t burst = std::max(rate / 10, kMinBlock);
    const bool was_limited = limited();
    bucket_.set_rate(rate, burst, instant(now));
    if (was_limited) return;
    // Start with an empty bucket: time before now must not allow a burst.
    bucket_ = TokenBucket(rate, burst, instant(now));
    bucket_.take(burst, instant(now));
  }
  [[nodiscard]] std::uint64_t bytes_per_second() const { return bucket_.rate(); }
  [[nodiscard]] bool limited() const { return bucket_.rate() > 0; }
  [[nodiscard]] bool admits(TimePoint now) const { return !limited() || bucket_.has(1, instant(now)); }
  void use(std::uint64_t bytes, TimePoint now) {
    if (limited()) bucket_.take(bytes, instant(now));
  }
  /// Returns the time from which bytes are admitted.
  [[nodiscard]] TimePoint next(TimePoint now) const {
    return TimePoint(std::chrono::ceil<TimePoint::duration>(bucket_.when(1, instant(now))));
  }
  /// Returns the size of the blocks in which bytes are delivered, at most `most`.
  [[nodiscard]] long block_size(long most) const {
    const std::uint64_t rate = asked_;
    if (rate == 0) return most;
    return static_cast<long>(std::clamp<std::uint64_t>(rate / 10, kMinBlock, static_cast<std::uint64_t>(most)));
  }

 private:
  static constexpr std::uint64_t kMinBlock = 1 << 10;  // bytes that are delivered at once
  static Instant instant(TimePoint time) { return std::chrono::duration_cast<Instant>(time.time_since_epoch()); }

  mutable TokenBucket bucket_;  // queries refill it
  std::atomic<std::uint64_t> asked_;
  std::uint64_t followed_ = 0;
};

}  // namespace gs::net
