#include "tests/vrml/events/trace.h"

#include <algorithm>
#include <limits>
#include <string>

namespace gs::vrml::traces {

// World::kStart is 1000. Traces have times since then, SFTime values are absolute.

TEST_CASE("sends nothing from a TimeSensor with default fields (4.6.9)") {
  World world(
      "TimeSensor { } DEF Past TimeSensor { startTime 100 cycleInterval 800 } "
      "DEF Stopped TimeSensor { loop TRUE startTime 100 stopTime 900 }");
  world.start();
  for (int i = 1; i < 10; ++i) CHECK(world.take_at(i).empty());
}

TEST_CASE("activates a TimeSensor with loop TRUE when the world begins (4.6.9, 6.50)") {
  World world("DEF T TimeSensor { loop TRUE cycleInterval 4 }");
  world.start();
  // 1000 is the end of a cycle, so the fraction is 1 and not 0.
  CHECK(world.take() == Lines{"0 T.isActive TRUE", "0 T.cycleTime 1000", "0 T.fraction_changed 1", "0 T.time 1000"});
  CHECK(world.take_at(1) == Lines{"1 T.fraction_changed 0.25", "1 T.time 1001"});
  CHECK(world.take_at(4) == Lines{"4 T.cycleTime 1004", "4 T.fraction_changed 1", "4 T.time 1004"});
}

TEST_CASE("sends isActive, cycleTime and fractions up to 1 in one cycle (6.50)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 }");
  world.start();
  CHECK(world.take_at(0.5).empty());
  CHECK(world.take_at(1) ==
        Lines{"1 T.isActive TRUE", "1 T.cycleTime 1001", "1 T.fraction_changed 0", "1 T.time 1001"});
  CHECK(world.take_at(2) == Lines{"2 T.fraction_changed 0.5", "2 T.time 1002"});
  CHECK(world.take_at(3.5) == Lines{"3.5 T.fraction_changed 1", "3.5 T.time 1003", "3.5 T.isActive FALSE"});
  CHECK(world.take_at(4).empty());
}

TEST_CASE("ends the last cycle with fraction 1 despite the rounding of present-day timestamps (6.50)") {
  World world("DEF T TimeSensor { cycleInterval 0.1 }");
  constexpr double kNow = 946684800;
  world.start(kNow - World::kStart);
  world.send("T.startTime", SFTime{kNow + 0.05});
  for (int i = 1; i < 20; ++i) world.step(kNow - World::kStart + i / 60.0);
  const Lines fractions = world.take("fraction_changed");
  REQUIRE(!fractions.empty());
  CHECK(fractions.back().find("fraction_changed 1") != std::string::npos);
}

TEST_CASE("sends only the cycleTime of the current cycle if several cycles fit in one step (6.50)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  world.step(1);
  (void)world.take();
  CHECK(world.take_at(8.5) == Lines{"8.5 T.cycleTime 1007", "8.5 T.fraction_changed 0.75", "8.5 T.time 1008.5"});
}

TEST_CASE("reports an activity that is shorter than a step (6.50)") {
  World world(
      "DEF T TimeSensor { startTime 1001.25 cycleInterval 0.5 } "
      "DEF U TimeSensor { startTime 1001.25 stopTime 1001.5 cycleInterval 1 loop TRUE }");
  world.start();
  world.step(1);
  CHECK(world.take_at(2) == Lines{"2 T.isActive TRUE", "2 T.cycleTime 1001.25", "2 T.fraction_changed 1",
                                  "2 T.time 1001.75", "2 U.isActive TRUE", "2 U.cycleTime 1001.25",
                                  "2 U.fraction_changed 0.25", "2 U.time 1001.5"});
  CHECK(world.take_at(3, "isActive") == Lines{"3 T.isActive FALSE", "3 U.isActive FALSE"});
  CHECK(world.take_at(4).empty());
}

TEST_CASE("ends an activity at stopTime only if it is after startTime (4.6.9)") {
  World world(
      "DEF T TimeSensor { startTime 1001 stopTime 1002.5 cycleInterval 2 loop TRUE } "
      "DEF U TimeSensor { startTime 1001 stopTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  for (int i = 1; i < 10; ++i) world.step(i);
  const Lines trace = world.take();
  CHECK(std::count(trace.begin(), trace.end(), "3 T.isActive FALSE") == 1);
  CHECK(std::count(trace.begin(), trace.end(), "3 T.fraction_changed 0.75") == 1);  // at stopTime
  CHECK(std::count(trace.begin(), trace.end(), "9 U.time 1009") == 1);
}

TEST_CASE("ignores set_cycleInterval, set_startTime and a stopTime before it while active (4.6.9)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  world.step(1);
  (void)world.take();
  world.send("T.cycleInterval", SFTime{20});
  world.send("T.startTime", SFTime{1005});
  world.send("T.stopTime", SFTime{1001});
  CHECK(world.take().empty());
  world.send("T.stopTime", SFTime{1002});
  CHECK(world.take() == Lines{"1 T.stopTime 1002"});
  CHECK(world.take_at(2) == Lines{"2 T.fraction_changed 0.5", "2 T.time 1002", "2 T.isActive FALSE"});
  world.send("T.cycleInterval", SFTime{20});
  world.send("T.startTime", SFTime{1005});
  CHECK(world.take() == Lines{"2 T.cycleInterval 20", "2 T.startTime 1005"});
}

TEST_CASE("ends with the current cycle on loop FALSE (4.6.9)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  world.step(1);
  world.send_at(4, "T.loop", SFBool{false});
  (void)world.take();
  CHECK(world.take_at(4.5) == Lines{"4.5 T.fraction_changed 0.75", "4.5 T.time 1004.5"});
  CHECK(world.take_at(6) == Lines{"6 T.fraction_changed 1", "6 T.time 1005", "6 T.isActive FALSE"});
}

TEST_CASE("stops at once on enabled FALSE, and starts on TRUE as startTime and loop demand (6.50)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  world.step(1);
  world.step(2);
  (void)world.take();
  world.send_at(2.5, "T.enabled", SFBool{false});
  CHECK(world.take() ==
        Lines{"2.5 T.fraction_changed 0.75", "2.5 T.time 1002.5", "2.5 T.enabled FALSE", "2.5 T.isActive FALSE"});
  CHECK(world.take_at(3).empty());
  world.send_at(3.5, "T.enabled", SFBool{true});
  CHECK(world.take() == Lines{"3.5 T.enabled TRUE", "3.5 T.isActive TRUE", "3.5 T.cycleTime 1003",
                              "3.5 T.fraction_changed 0.25", "3.5 T.time 1003.5"});
}

TEST_CASE("restarts if stopTime and startTime are set at one time (4.6.9)") {
  World world(
      "DEF T TimeSensor { startTime 1001 cycleInterval 10 } DEF S TimeSensor { } "
      "ROUTE S.startTime TO T.startTime ROUTE S.startTime TO T.stopTime");
  world.start();
  world.step(1);
  world.step(3);
  (void)world.take();
  world.send("S.startTime", SFTime{1003});
  CHECK(world.take("T.") == Lines{"3 T.stopTime 1003", "3 T.isActive FALSE", "3 T.startTime 1003"});
  CHECK(world.take_at(4, "T.") ==
        Lines{"4 T.isActive TRUE", "4 T.cycleTime 1003", "4 T.fraction_changed 0.1", "4 T.time 1004"});
}

TEST_CASE("starts a TimeSensor in the cascade that sets its startTime (4.10.3)") {
  World world(
      "DEF A TimeSensor { startTime 1001 cycleInterval 2 } DEF B TimeSensor { cycleInterval 4 } "
      "DEF P ScalarInterpolator { key [ 0 1 ] keyValue [ 5 9 ] } "
      "ROUTE A.cycleTime TO B.startTime ROUTE B.fraction_changed TO P.set_fraction");
  world.start();
  CHECK(world.take_at(1) == Lines{"1 A.isActive TRUE", "1 A.cycleTime 1001", "1 A.fraction_changed 0", "1 A.time 1001",
                                  "1 B.startTime 1001", "1 B.isActive TRUE", "1 B.cycleTime 1001",
                                  "1 B.fraction_changed 0", "1 B.time 1001", "1 P.value_changed 5"});
  CHECK(world.take_at(2, "P.") == Lines{"2 P.value_changed 6"});
}

TEST_CASE("survives NaN, infinite and huge times") {
  World world(
      "DEF T TimeSensor { loop TRUE cycleInterval 0 } DEF U TimeSensor { loop TRUE cycleInterval 1e-300 }"
      "DEF V TimeSensor { loop TRUE cycleInterval -3 startTime 1e300 } DEF W TimeSensor { startTime 1001 }");
  world.start();
  world.send("W.startTime", SFTime{std::numeric_limits<double>::quiet_NaN()});
  world.send("W.stopTime", SFTime{std::numeric_limits<double>::infinity()});
  world.send("W.startTime", SFTime{-std::numeric_limits<double>::infinity()});
  for (int i = 1; i < 100; ++i) {
    world.send_at(i, "V.startTime", SFTime{1e300 + i * 1e285});
    world.send("W.startTime", SFTime{1e9 + i});
  }
  CHECK(world.scene().get<SFTime>(world.node("W"), "startTime") == 1e9 + 99);
}

TEST_CASE("never lets time run backwards (4.11)") {
  World world("DEF T TimeSensor { loop TRUE }");
  world.start();
  world.step(2.5);
  (void)world.take();
  world.step(1);
  CHECK(world.take_at(2.5).empty());
  CHECK(world.execution().now() == 1002.5);
}

}  // namespace gs::vrml::traces
