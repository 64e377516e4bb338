#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gs::render {

/// What a program that draws a picture is busy with, or waits for.
enum class Phase : std::uint8_t { other, read, parse, tessellate, compile, upload, cut, draw, write };
/// By Phase.
inline constexpr std::array<std::string_view, 9> kPhaseNames = {"other",  "read", "parse", "tessellate", "compile",
                                                                "upload", "cut",  "draw",  "write"};

/// Shares the time that goes by out among phases, so that their sum is all of it: one phase lasts until another begins.
/// One thread; what others do meanwhile counts as what this one does or waits for.
class PhaseClock {
 public:
  /// `now` tells the time in seconds; the first phase, `other`, begins at `begin`.
  PhaseClock(double (*now)(), double begin) : now_(now), begin_(begin), entered_(begin) {}

  /// Begins a phase; the one that lasted until now.
  Phase enter(Phase phase) {
    const double now = now_();
    seconds_[static_cast<std::size_t>(phase_)] += now - entered_;
    entered_ = now;
    const Phase before = phase_;
    phase_ = phase;
    return before;
  }
  /// Of a phase so far: until the last `enter`.
  [[nodiscard]] double seconds(Phase phase) const { return seconds_[static_cast<std::size_t>(phase)]; }
  /// From the beginning to the last `enter`.
  [[nodiscard]] double total() const { return entered_ - begin_; }

 private:
  double (*now_)();
  double begin_, entered_;
  Phase phase_ = Phase::other;
  std::array<double, kPhaseNames.size()> seconds_{};
};

/// A phase for as long as it lives, and then again the one before. Nothing where there is no clock.
class PhaseScope {
 public:
  PhaseScope(PhaseClock* clock, Phase phase) : clock_(clock), before_(clock ? clock->enter(phase) : phase) {}
  ~PhaseScope() {
    if (clock_) clock_->enter(before_);
  }
  PhaseScope(const PhaseScope&) = delete;
  PhaseScope& operator=(const PhaseScope&) = delete;

 private:
  PhaseClock* clock_;
  Phase before_;
};

}  // namespace gs::render
