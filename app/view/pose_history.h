#pragma once

#include "app/view/navigation.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace gs::app {

/// Where a viewer has rested, so that he can go back there: what he does without resting in between is one movement.
/// A plain value.
class PoseHistory {
 public:
  static constexpr std::size_t kMostPlaces = 100;  // then the oldest are forgotten
  static constexpr double kRest = 0.5;             // seconds without moving that end a movement

  /// The viewer went from one place to another at `now`, in seconds.
  void moved(const Pose& from, const Pose& to, double now);
  /// Where he rested before (-1), or was taken back from (1), seen from where he is. Nothing: there is no such place.
  /// He is on his way there until `moved` tells of a place that is not between the two.
  [[nodiscard]] std::optional<Pose> go(int direction, const Pose& from);
  [[nodiscard]] bool can_go(int direction) const { return !(direction < 0 ? behind_ : ahead_).empty(); }
  /// What he does now is a movement of his own, even if he was being taken somewhere.
  void interrupt() { taken_ = false; }

 private:
  std::vector<Pose> behind_, ahead_;  // the nearest in time is last
  std::optional<Pose> goal_;          // where he is being taken
  bool taken_ = false;
  double last_ = -1e9;  // when he moved
};

}  // namespace gs::app
