#include "app/viewer/frame_rate.h"

namespace gs::app {

void FrameRate::drawn(double time, bool in_motion) {
  constexpr double kLookedAt = 1;  // seconds over which the rate is measured
  if (!in_motion || (!begun_.empty() && time < begun_.back())) begun_.clear();
  begun_.push_back(time);
  while (begun_.size() > 2 && begun_.front() < time - kLookedAt) begun_.pop_front();
}

double FrameRate::a_second() const {
  if (begun_.size() < 2 || begun_.back() <= begun_.front()) return 0;
  return static_cast<double>(begun_.size() - 1) / (begun_.back() - begun_.front());
}

}  // namespace gs::app
