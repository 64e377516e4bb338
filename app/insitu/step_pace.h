#pragma once

#include <cstdint>

namespace gs::app::insitu {

/// Scheduler on rank 0 that decides which steps are taken, so that the library keeps to its share of run time. Times
/// are seconds since the session began. Has no clock of its own.
class StepPace {
 public:
  /// `most_share` is the maximum share of run time; 0 means unlimited. Takes at most each `every`-th step.
  StepPace(double most_share, std::int64_t every) : most_share_(most_share), every_(every < 1 ? 1 : every) {}

  /// Reports whether the step `number`, counted from 0, may be taken at the time `now`. `own` is the time that the
  /// library has used. The first step may always be taken, because it measures the cost.
  [[nodiscard]] bool may_take(std::int64_t number, double now, double own) const;
  /// Changes the maximum share of run time.
  void set_share(double most_share) { most_share_ = most_share; }
  /// Returns the expected cost of the next step in seconds.
  [[nodiscard]] double cost() const { return cost_; }
  /// Notes the seconds that a taken step cost, and the bytes of its grids; 0 bytes means no grid.
  void note_cost(double seconds, std::uint64_t bytes = 0);
  /// Returns the bytes of grids that the share permits if each wanted step is taken: each `every`-th step, and at most
  /// two per second. The first step gets a small size. Without a limited share, returns the maximum number.
  [[nodiscard]] std::uint64_t affordable_bytes(std::int64_t number, double now, double own) const;
  /// Returns the number of steps after the step `number` until the ranks must agree again, at least 1. If `takes` is
  /// false, no step is needed now. Then the ranks agree only on new parameters and viewers, every `interval` seconds.
  /// With an interval below kContactSeconds, they also agree at steps that cannot be taken.
  [[nodiscard]] std::int64_t steps_until_contact(std::int64_t number, double now, double own, bool takes,
                                                 double interval = kContactSeconds) const;

  static constexpr double kContactSeconds = 0.25;  // interval for new parameters and viewers
  static constexpr double kQuickContact = 0.05;    // interval while viewers may request chunks

 private:
  double most_share_ = 0, cost_ = 0;
  double byte_seconds_ = 1e-8;  // cost of a byte of a grid; a guess until the first grid is encoded
  std::int64_t every_ = 1;
  bool known_ = false;
};

}  // namespace gs::app::insitu
