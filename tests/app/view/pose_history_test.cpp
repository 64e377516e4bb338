#include "app/view/pose_history.h"

#include <catch2/catch.hpp>

// Tests of undoing movements.
namespace gs::app::pose_history_test {

namespace {

Pose at(double x) {
  Pose pose;
  pose.position.x = x;
  return pose;
}

}  // namespace

TEST_CASE("joins continuous movements to one, and undoes and redoes it") {
  PoseHistory history;
  CHECK_FALSE(history.can_go(-1));
  CHECK_FALSE(history.go(-1, at(0)));
  for (int i = 0; i < 10; ++i) history.moved(at(i), at(i + 1), i * 0.1);
  history.moved(at(10), at(20), 5);  // after a rest
  const auto before = history.go(-1, at(20));
  REQUIRE(before);
  CHECK(before->position.x == 10);
  // The transition to the restored pose is not a movement of the user.
  history.moved(at(20), at(15), 5.1);
  history.moved(at(15), at(10), 5.2);
  const auto first = history.go(-1, at(10));
  REQUIRE(first);
  CHECK(first->position.x == 0);
  CHECK_FALSE(history.can_go(-1));
  history.moved(at(10), at(0), 5.3);
  CHECK(history.go(1, at(0))->position.x == 10);
  history.moved(at(0), at(10), 5.4);
  CHECK(history.go(1, at(10))->position.x == 20);
  CHECK_FALSE(history.can_go(1));
}

TEST_CASE("drops undone movements after a new one, and undoes a running one from its destination") {
  PoseHistory history;
  history.moved(at(0), at(1), 0);
  history.moved(at(1), at(2), 10);
  CHECK(history.go(-1, at(2))->position.x == 1);
  // The transition is not finished.
  history.moved(at(2), at(1.5), 10.1);
  CHECK(history.go(-1, at(1.5))->position.x == 0);
  CHECK(history.go(1, at(1.2))->position.x == 1);
  history.interrupt();
  history.moved(at(1.2), at(7), 20);
  CHECK_FALSE(history.can_go(1));
  CHECK(history.go(-1, at(7))->position.x == 1.2);
}

TEST_CASE("reports the begin of the movement to undo or redo") {
  PoseHistory history;
  CHECK_FALSE(history.time_of(-1));
  history.moved(at(0), at(1), 3);
  history.moved(at(1), at(2), 3.1);
  history.moved(at(2), at(3), 8);
  CHECK(history.time_of(-1) == 8);
  (void)history.go(-1, at(3));
  CHECK(history.time_of(-1) == 3);
  CHECK(history.time_of(1) == 8);
}

TEST_CASE("forgets the oldest positions") {
  PoseHistory history;
  for (int i = 0; i < 500; ++i) history.moved(at(i), at(i + 1), i);
  std::size_t places = 0;
  for (double x = 500; history.can_go(-1); ++places) {
    const Pose place = *history.go(-1, at(x));
    CHECK(place.position.x == x - 1);
    history.moved(at(x), place, 0);
    x = place.position.x;
  }
  CHECK(places == PoseHistory::kMaxPlaces);
}

}  // namespace gs::app::pose_history_test
