#include "app/interface/base/notices.h"

#include <catch2/catch.hpp>

namespace gs::app::notices_test {

TEST_CASE("queues a second line instead of replacing the first") {
  Notices notices;
  CHECK_FALSE(notices.next());
  notices.show("Cannot open a.wrl", true, 10);
  notices.show("Speed 2 m/s", false, 11);
  REQUIRE(notices.lines().size() == 2);
  CHECK(notices.lines()[0].text == "Cannot open a.wrl");
  CHECK(notices.next() == 11 + Notices::kSeconds);
  notices.expire(11 + Notices::kSeconds);
  REQUIRE(notices.lines().size() == 1);
  CHECK(notices.lines()[0].is_problem);
  notices.expire(10 + Notices::kProblemSeconds);
  CHECK(notices.lines().empty());
}

TEST_CASE("shows only the newest line of a repeated notice") {
  Notices notices;
  notices.show("Speed 1 m/s", false, 0, "speed");
  notices.show("The roof", false, 0, "viewpoint");
  notices.show("Saved", false, 0);
  notices.show("Speed 2 m/s", false, 1, "speed");
  notices.show("Copied", false, 1);
  REQUIRE(notices.lines().size() == 4);
  CHECK(notices.lines()[0].text == "The roof");
  CHECK(notices.lines()[2].text == "Speed 2 m/s");
}

TEST_CASE("shows lines once, a few at a time, and closes them one by one") {
  Notices notices;
  for (int i = 0; i < 3; ++i) notices.show("Louder", false, i);
  REQUIRE(notices.lines().size() == 1);
  CHECK(notices.lines()[0].until == 2 + Notices::kSeconds);
  for (int i = 0; i < 9; ++i) notices.show(std::to_string(i), true, 3);
  CHECK(notices.lines().size() == Notices::kMax);
  CHECK(notices.lines().back().text == "8");
  notices.close(0);
  CHECK(notices.lines().front().text == "5");
  notices.close(99);
  CHECK(notices.lines().size() == Notices::kMax - 1);
  while (notices.close_one()) {
  }
  CHECK(notices.lines().empty());
}

}  // namespace gs::app::notices_test
