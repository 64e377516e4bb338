#pragma once

#include "base/noncopyable.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gs {

/// Kind of work that the program does, or waits for, while it draws pictures.
enum class Phase : std::uint8_t { other, read, parse, tessellate, compile, upload, cut, draw, write };
/// Names, indexed by Phase.
inline constexpr std::array<std::string_view, 9> kPhaseNames = {"other",  "read", "parse", "tessellate", "compile",
                                                                "upload", "cut",  "draw",  "write"};

/// Clock that divides elapsed time into phases: one phase lasts until the next begins, so their sum is the total.
/// Single-threaded. Work of other threads counts towards the current phase of this thread.
class PhaseClock {
 public:
  /// `now` returns the time in seconds. The first phase, `other`, starts at `begin`.
  PhaseClock(double (*now)(), double begin) : now_(now), begin_(begin), entered_(begin) {}

  /// Begins a phase and returns the previous one.
  Phase enter(Phase phase) {
    const double now = now_();
    seconds_[static_cast<std::size_t>(phase_)] += now - entered_;
    entered_ = now;
    const Phase before = phase_;
    phase_ = phase;
    return before;
  }
  /// Returns the time of a phase up to the last `enter`.
  [[nodiscard]] double seconds(Phase phase) const { return seconds_[static_cast<std::size_t>(phase)]; }
  /// Returns the time from the start to the last `enter`.
  [[nodiscard]] double total() const { return entered_ - begin_; }

 private:
  double (*now_)();
  double begin_, entered_;
  Phase phase_ = Phase::other;
  std::array<double, kPhaseNames.size()> seconds_{};
};

/// Guard that enters a phase for its lifetime, then returns to the previous phase. Does nothing without a clock.
class PhaseScope : NonCopyable {
 public:
  PhaseScope(PhaseClock* clock, Phase phase) : clock_(clock), before_(clock ? clock->enter(phase) : phase) {}
  ~PhaseScope() {
    if (clock_) clock_->enter(before_);
  }

 private:
  PhaseClock* clock_;
  Phase before_;
};

}  // namespace gs
