#pragma once

#include <deque>

namespace gs::app {

/// How many pictures a second are drawn where each differs from the one before: of the last second, or of the last two.
class FrameRate {
 public:
  /// A picture was begun at `time`, in seconds. Not `in_motion`: that is an end of what moved.
  void drawn(double time, bool in_motion);
  /// 0: nothing moves.
  [[nodiscard]] double a_second() const;

 private:
  std::deque<double> begun_;  // in rising order
};

}  // namespace gs::app
