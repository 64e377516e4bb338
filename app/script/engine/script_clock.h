#pragma once

#include <cstdint>
#include <limits>

namespace gs::app::script {

/// Time and random numbers that programs read, which can be repeatable. One thread.
class ScriptClock {
 public:
  explicit ScriptClock(bool repeatable) : repeatable_(repeatable) {}

  [[nodiscard]] bool is_repeatable() const { return repeatable_; }
  /// Begins a function of a program at the time `now` of the world.
  void begin_function(double now) {
    now_ = now;
    looks_ = 0;
  }
  [[nodiscard]] double now() const { return now_; }
  /// Returns the time for Date in seconds since 1970: simulated time, which is constant during a function. After kLooks
  /// reads in one function, each read adds kLook, so that a loop that waits for time to pass ends.
  [[nodiscard]] double date() {
    constexpr std::uint32_t kLooks = 1000;
    constexpr double kLook = 1e-3;  // seconds
    if (looks_ < std::numeric_limits<std::uint32_t>::max()) ++looks_;
    return now_ + (looks_ > kLooks ? kLook * (looks_ - kLooks) : 0);
  }
  /// Returns a number from 0 to 1 of a fixed sequence.
  [[nodiscard]] double random() {
    random_ ^= random_ << 13;
    random_ ^= random_ >> 7;
    random_ ^= random_ << 17;
    return static_cast<double>(random_ >> 11) * 0x1.0p-53;
  }

 private:
  const bool repeatable_;
  double now_ = 0;
  std::uint32_t looks_ = 0;  // number of reads of the clock in the running function
  std::uint64_t random_ = 0x9e3779b97f4a7c15U;
};

}  // namespace gs::app::script
