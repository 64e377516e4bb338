#pragma once

#include "app/view/navigation.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace gs::app {

/// Undo history of viewer poses. Movements without a rest in between count as one. A plain value.
class PoseHistory {
 public:
  static constexpr std::size_t kMaxPlaces = 100;  // max entries; the oldest ones are dropped
  static constexpr double kRest = 0.5;            // seconds without movement that end a movement

  /// Records a movement from one pose to another at `now`, in seconds.
  void moved(const Pose& from, const Pose& to, double now);
  /// Returns the previous resting pose (-1), or the one that was undone (1); nullopt if there is none. `from` is the
  /// present pose. The transition lasts until `moved` reports the returned pose.
  [[nodiscard]] std::optional<Pose> go(int direction, const Pose& from);
  [[nodiscard]] bool can_go(int direction) const { return !(direction < 0 ? behind_ : ahead_).empty(); }
  /// Makes the next movement count as the user's own, even during a transition of `go`.
  void interrupt() { taken_ = false; }

 private:
  std::vector<Pose> behind_, ahead_;  // nearest in time last
  std::optional<Pose> goal_;          // goal of the current transition
  bool taken_ = false;
  double last_ = -1e9;  // time of the last movement
};

}  // namespace gs::app
