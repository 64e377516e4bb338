#pragma once

#include "app/view/navigation.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace gs::app {

/// History of the viewer's poses, for undo and redo. Movements without a rest between them count as one.
class PoseHistory {
 public:
  static constexpr std::size_t kMaxPlaces = 100;  // max entries; beyond it, the oldest are dropped
  static constexpr double kRest = 0.5;            // seconds without movement that count as a rest

  /// Records a movement from one pose to another at `now`, in seconds.
  void moved(const Pose& from, const Pose& to, double now);
  /// Returns the pose before the last movement (-1), or the pose that was undone last (1); nullopt if there is none.
  /// `from` is the present pose. The caller must start a transition to the result. The transition ends when moved()
  /// reports that pose.
  [[nodiscard]] std::optional<Pose> go(int direction, const Pose& from);
  [[nodiscard]] bool can_go(int direction) const { return !(direction < 0 ? behind_ : ahead_).empty(); }
  /// Returns the time at which the movement began that go() would undo (-1) or redo (1); nullopt if there is none.
  [[nodiscard]] std::optional<double> time_of(int direction) const;
  /// Ends a transition of go(), so that the next movement counts as one of the user.
  void interrupt() { taken_ = false; }

 private:
  struct Entry {
    Pose pose;
    double time = 0;  // begin of the movement
  };
  std::vector<Entry> behind_, ahead_;  // for undo and for redo; the next entry is the last one
  std::optional<Pose> goal_;           // goal of the last transition of go()
  bool taken_ = false;
  double last_ = -1e9;  // time of the last movement, in seconds
};

}  // namespace gs::app
