#pragma once

#include <deque>

namespace gs::app {

/// Rate of pictures in motion, over the last second or at least the last two pictures.
class FrameRate {
 public:
  /// Records a picture that was begun at `time`, in seconds. `in_motion` is false for the last picture of a motion.
  void drawn(double time, bool in_motion);
  /// Returns the pictures per second, or 0 without motion.
  [[nodiscard]] double a_second() const;

 private:
  std::deque<double> begun_;  // ascending
};

}  // namespace gs::app
