#include "app/insitu/step_pace.h"

#include <algorithm>

namespace gs::app::insitu {

bool StepPace::may_take(std::int64_t number, double now, double own) const {
  if (number % every_ != 0) return false;
  if (most_share_ <= 0 || !known_) return true;
  return own + cost_ <= most_share_ * (now + cost_);
}

void StepPace::note_cost(double seconds) {
  // A step may cost more than the one before. A cost that falls again is trusted slowly.
  constexpr double kTrust = 0.5;
  cost_ = known_ ? std::max(seconds, cost_ + (seconds - cost_) * kTrust) : seconds;
  known_ = true;
}

std::int64_t StepPace::steps_until_contact(std::int64_t number, double now, double own, bool takes) const {
  const double step_seconds = number > 0 ? std::max(now - own, 0.0) / static_cast<double>(number) : 0;
  std::int64_t steps = 1;
  constexpr std::int64_t kMostSteps = 10'000;
  if (step_seconds > 0)
    steps = std::clamp(static_cast<std::int64_t>(kContactSeconds / step_seconds), std::int64_t{1}, kMostSteps);
  if (takes && (most_share_ <= 0 || !known_)) steps = 1;
  if (takes && most_share_ > 0 && known_) {
    // The share allows the next step at this time.
    const double until = (own + cost_) / most_share_ - cost_;
    const double wait = std::max(until - now, 0.0);
    if (step_seconds > 0)
      steps = std::clamp(static_cast<std::int64_t>(wait / step_seconds) + 1, std::int64_t{1}, steps);
  }
  // Steps between multiples of `every` cannot be taken.
  const std::int64_t to_next = every_ - number % every_;
  return takes && every_ > 1 ? to_next + (steps - 1) / every_ * every_ : steps;
}

}  // namespace gs::app::insitu
