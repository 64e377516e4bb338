#include "app/session/opening/travel_history.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::travel_history_test {

TEST_CASE("goes back and forward through worlds, to the earlier position") {
  TravelHistory history;
  CHECK_FALSE(history.can_go(-1));
  CHECK(history.current().empty());
  Pose pose;
  history.visit("a", std::nullopt);
  pose.position = {1, 0, 0};
  history.visit("b", pose);
  pose.position = {2, 0, 0};
  history.visit("c", pose);
  CHECK_FALSE(history.go(1, pose));
  pose.position = {3, 0, 0};
  auto place = history.go(-1, pose);
  REQUIRE(place);
  CHECK(place->path == "b");
  CHECK(place->pose->position.x == 2);
  place = history.go(-1, std::nullopt);
  REQUIRE(place);
  CHECK(place->path == "a");
  CHECK(place->pose->position.x == 1);
  CHECK_FALSE(history.can_go(-1));
  place = history.go(1, std::nullopt);
  REQUIRE(place);
  CHECK(place->pose->position.x == 2);
  place = history.go(1, std::nullopt);
  REQUIRE(place);
  CHECK(place->pose->position.x == 3);
}

TEST_CASE("drops the forward history after a new destination") {
  TravelHistory history;
  for (const char* path : {"a", "b", "c"}) history.visit(path, std::nullopt);
  (void)history.go(-1, std::nullopt);
  (void)history.go(-1, std::nullopt);
  history.visit("d", std::nullopt);
  CHECK_FALSE(history.can_go(1));
  CHECK(history.current() == "d");
  CHECK(history.go(-1, std::nullopt)->path == "a");
}

TEST_CASE("forgets the oldest of very many destinations") {
  TravelHistory history;
  for (std::size_t i = 0; i < 3 * TravelHistory::kMaxVisits; ++i) history.visit(std::to_string(i), std::nullopt);
  std::size_t back = 0;
  while (history.can_go(-1)) {
    (void)history.go(-1, std::nullopt);
    ++back;
  }
  CHECK(back == TravelHistory::kMaxVisits - 1);
}

}  // namespace gs::app::travel_history_test
