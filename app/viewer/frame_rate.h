#pragma once

#include <deque>

namespace gs::app {

/// Frame rate during motion, measured over the last second, or over the last two pictures if these are further apart.
class FrameRate {
 public:
  /// Records a picture that was begun at `time`, in seconds. `in_motion` is false if it is the last picture of a
  /// motion.
  void drawn(double time, bool in_motion);
  /// Returns the number of pictures per second; 0 if nothing moves.
  [[nodiscard]] double a_second() const;

 private:
  std::deque<double> begun_;  // times at which pictures were begun, in ascending order
};

}  // namespace gs::app
