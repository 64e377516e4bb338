#include "app/insitu/step_pace.h"

#include <algorithm>

namespace gs::app::insitu {
namespace {

// Safety factor: a step is taken if the share permits this multiple of the expected cost.
constexpr double kReserve = 1.2;

}  // namespace

bool StepPace::may_take(std::int64_t number, double now, double own) const {
  if (number % every_ != 0) return false;
  if (most_share_ <= 0 || !known_) return true;
  return own + kReserve * cost_ <= most_share_ * now;
}

std::uint64_t StepPace::affordable_bytes(std::int64_t number, double now, double own) const {
  if (most_share_ <= 0) return UINT64_MAX;
  constexpr std::uint64_t kFirstBytes = std::uint64_t{256} << 10;
  if (number <= 0 || now <= own) return kFirstBytes;
  constexpr double kPictureSeconds = 0.5, kMargin = 0.8;
  const double step_seconds = (now - own) / static_cast<double>(number);
  const double seconds = most_share_ * std::max(step_seconds * static_cast<double>(every_), kPictureSeconds);
  return static_cast<std::uint64_t>(std::min(kMargin * seconds / byte_seconds_, 1e18));
}

void StepPace::note_cost(double seconds, std::uint64_t bytes) {
  // Uses only the last cost per byte, because small grids cost more per byte.
  if (bytes > 0) byte_seconds_ = std::max(seconds / static_cast<double>(bytes), 1e-12);
  // The estimate follows rising costs at once, and falling costs slowly.
  constexpr double kTrust = 0.5;
  cost_ = known_ ? std::max(seconds, cost_ + (seconds - cost_) * kTrust) : seconds;
  known_ = true;
}

std::int64_t StepPace::steps_until_contact(std::int64_t number, double now, double own, bool takes,
                                           double interval) const {
  const double step_seconds = number > 0 ? std::max(now - own, 0.0) / static_cast<double>(number) : 0;
  std::int64_t steps = 1;
  constexpr std::int64_t kMostSteps = 10'000;
  if (step_seconds > 0)
    steps = std::clamp(static_cast<std::int64_t>(interval / step_seconds), std::int64_t{1}, kMostSteps);
  if (takes && (most_share_ <= 0 || !known_)) steps = 1;
  if (takes && most_share_ > 0 && known_) {
    // Time from which the share permits the next step.
    const double until = (own + kReserve * cost_) / most_share_;
    const double wait = std::max(until - now, 0.0);
    if (step_seconds > 0)
      steps = std::clamp(static_cast<std::int64_t>(wait / step_seconds) + 1, std::int64_t{1}, steps);
  }
  // Steps between multiples of `every` cannot be taken.
  const std::int64_t to_next = every_ - number % every_;
  if (!takes || every_ <= 1) return steps;
  return interval < kContactSeconds ? std::min(steps, to_next) : to_next + (steps - 1) / every_ * every_;
}

}  // namespace gs::app::insitu
