#pragma once

#include <cstdint>

namespace gs::app::insitu {

/// Decides on rank 0 which steps are taken, so that the library keeps to its share of run time. Times are seconds since
/// the session began. Has no clock of its own.
class StepPace {
 public:
  /// `most_share` is the maximum share of run time; 0 means unlimited. Takes at most each `every`-th step.
  StepPace(double most_share, std::int64_t every) : most_share_(most_share), every_(every < 1 ? 1 : every) {}

  /// Reports whether the step `number`, counted from 0, may be taken at the time `now`, after the library has taken
  /// `own` seconds. The first step may always be taken: it shows the cost.
  [[nodiscard]] bool may_take(std::int64_t number, double now, double own) const;
  /// Notes the cost of a step that was taken: seconds, and bytes of its grids; 0 bytes means no grid.
  void note_cost(double seconds, std::uint64_t bytes = 0);
  /// Returns the size of grids that the share permits if each wanted step is taken: at most each `every`-th, and two
  /// per second. Before anything is known, the size is small. Without a limit of the share, returns the largest number.
  [[nodiscard]] std::uint64_t affordable_bytes(std::int64_t number, double now, double own) const;
  /// Returns the number of steps until the ranks must agree again, at least 1, after the step `number` at the time
  /// `now`. Without `takes`, no step is needed now, and the ranks only agree often enough for new parameters.
  [[nodiscard]] std::int64_t steps_until_contact(std::int64_t number, double now, double own, bool takes) const;

  static constexpr double kContactSeconds = 0.25;  // interval for new parameters and viewers

 private:
  double most_share_ = 0, cost_ = 0;
  double byte_seconds_ = 1e-8;  // cost of a byte of a grid; a first estimate, until a grid was encoded
  std::int64_t every_ = 1;
  bool known_ = false;
};

}  // namespace gs::app::insitu
