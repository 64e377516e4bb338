#include "tests/vrml/events/trace.h"

#include <algorithm>
#include <string>

namespace gs::vrml::traces {

// World::kStart is 1000. Traces have times since then, SFTime values are absolute.

TEST_CASE("sends isActive only when an activity begins and ends (4.6.9)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 loop TRUE stopTime 1006 }");
  world.start();
  for (int i = 1; i < 100; ++i) world.step(i / 8.0);
  CHECK(world.take("isActive") == Lines{"1 T.isActive TRUE", "6 T.isActive FALSE"});
}

TEST_CASE("sends the exact end time and fraction if an activity ends between two steps (6.50)") {
  World world(
      "DEF T TimeSensor { startTime 1001 cycleInterval 2 } "
      "DEF U TimeSensor { startTime 1001 cycleInterval 2 loop TRUE stopTime 1003.5 }");
  world.start();
  world.step(1);
  (void)world.take();
  CHECK(world.take_at(4, "T.") == Lines{"4 T.fraction_changed 1", "4 T.time 1003", "4 T.isActive FALSE"});
  World other("DEF U TimeSensor { startTime 1001 cycleInterval 2 loop TRUE stopTime 1003.5 }");
  other.start();
  other.step(1);
  (void)other.take();
  CHECK(other.take_at(4) == Lines{"4 U.fraction_changed 0.25", "4 U.time 1003.5", "4 U.isActive FALSE"});
}

TEST_CASE("stops at the present on a set_stopTime in the past, and keeps the value that was set (4.6.9, 6.50)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 4 loop TRUE }");
  world.start();
  world.step(1);
  world.step(2);
  (void)world.take();
  world.send_at(3, "T.stopTime", SFTime{1001.5});
  CHECK(world.take() ==
        Lines{"3 T.fraction_changed 0.5", "3 T.time 1003", "3 T.stopTime 1001.5", "3 T.isActive FALSE"});
  CHECK(world.take_at(4).empty());
  CHECK(world.scene().get<SFTime>(world.node("T"), "stopTime") == 1001.5);
}

TEST_CASE("stops at the present on a set_stopTime that arrives before the sensor's own step (6.50)") {
  // S stops T in a cascade of the step in which T would continue.
  World world(R"(
DEF T TimeSensor { startTime 1001 cycleInterval 4 loop TRUE }
DEF S TimeSensor { startTime 1003 cycleInterval 9 } DEF Stop TimeSensor { enabled FALSE }
ROUTE S.cycleTime TO T.stopTime)");
  world.start();
  world.step(1);
  world.step(2);
  (void)world.take();
  CHECK(world.take_at(3.5, "T.") ==
        Lines{"3.5 T.fraction_changed 0.625", "3.5 T.time 1003.5", "3.5 T.stopTime 1003", "3.5 T.isActive FALSE"});
}

TEST_CASE("ignores set_stopTime at or before startTime while active, and accepts it while inactive (4.6.9)") {
  World world("DEF T TimeSensor { startTime 1002 cycleInterval 4 }");
  world.start();
  world.send("T.stopTime", SFTime{1001});
  CHECK(world.take() == Lines{"0 T.stopTime 1001"});
  world.step(2);
  (void)world.take();
  world.send("T.stopTime", SFTime{1002});
  world.send("T.stopTime", SFTime{5});
  CHECK(world.take().empty());
  CHECK(world.scene().get<SFTime>(world.node("T"), "stopTime") == 1001);
  world.send("T.stopTime", SFTime{1003});  // in the future: it ends at that time
  CHECK(world.take() == Lines{"2 T.stopTime 1003"});
  CHECK(world.take_at(3) == Lines{"3 T.fraction_changed 0.25", "3 T.time 1003", "3 T.isActive FALSE"});
}

TEST_CASE("cancels set_loop FALSE by set_loop TRUE before the cycle ends (4.6.9)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  world.step(1);
  world.send_at(1.5, "T.loop", false);
  world.send_at(2, "T.loop", true);
  (void)world.take();
  CHECK(world.take_at(3.5) == Lines{"3.5 T.cycleTime 1003", "3.5 T.fraction_changed 0.25", "3.5 T.time 1003.5"});
}

TEST_CASE("ends at stopTime after set_loop FALSE if stopTime precedes the end of the cycle (4.6.9)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 4 loop TRUE stopTime 1007 }");
  world.start();
  world.step(1);
  world.send_at(6, "T.loop", false);
  (void)world.take();
  CHECK(world.take_at(7) == Lines{"7 T.fraction_changed 0.5", "7 T.time 1007", "7 T.isActive FALSE"});
}

TEST_CASE("never ends a looping sensor with startTime at or after stopTime (4.6.9)") {
  World world("DEF T TimeSensor { startTime 1001 stopTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  for (int i = 1; i < 500; ++i) world.step(i);
  CHECK(world.take("isActive") == Lines{"1 T.isActive TRUE"});
}

TEST_CASE("does not activate a node with an interval before the start of the world (4.6.9)") {
  World world(
      "DEF Over TimeSensor { startTime 990 cycleInterval 5 } DEF Stopped TimeSensor { startTime 990 stopTime 999 loop "
      "TRUE } DEF Runs TimeSensor { startTime 998 cycleInterval 5 }");
  world.start();
  CHECK(world.take("isActive") == Lines{"0 Runs.isActive TRUE"});
  CHECK(world.take_at(1, "Over").empty());
}

TEST_CASE("restarts at a future startTime after a set_stopTime of now (4.6.9)") {
  World world(
      "DEF T TimeSensor { startTime 1001 cycleInterval 10 } DEF Now TimeSensor { enabled FALSE } DEF Then TimeSensor { "
      "enabled FALSE } ROUTE Now.startTime TO T.stopTime ROUTE Then.startTime TO T.startTime");
  world.start();
  world.step(3);
  world.step(4);
  (void)world.take();
  world.send("Now.startTime", SFTime{1004});
  world.send("Then.startTime", SFTime{1006});
  CHECK(world.take("T.") == Lines{"4 T.stopTime 1004", "4 T.isActive FALSE", "4 T.startTime 1006"});
  CHECK(world.take_at(5).empty());
  CHECK(world.take_at(6, "T.") ==
        Lines{"6 T.isActive TRUE", "6 T.cycleTime 1006", "6 T.fraction_changed 0", "6 T.time 1006"});
}

TEST_CASE("runs the cycle of a restart also if it is shorter than a step (4.6.9)") {
  World world(
      "DEF T TimeSensor { startTime 1001 cycleInterval 0.5 loop TRUE } DEF S TimeSensor { enabled FALSE } "
      "ROUTE S.startTime TO T.startTime ROUTE S.startTime TO T.stopTime ROUTE S.enabled TO T.loop");
  world.start();
  world.step(1);
  world.send_at(3, "T.loop", false);
  (void)world.take();
  world.send_at(3.25, "S.startTime", SFTime{1003.25});
  CHECK(world.take("T.isActive") == Lines{"3.25 T.isActive FALSE"});
  world.step(5);
  CHECK(world.take_at(6, "T.isActive") == Lines{"5 T.isActive TRUE", "6 T.isActive FALSE"});
}

TEST_CASE("restarts a sensor that has ended on set_startTime (4.6.9)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 1 }");
  world.start();
  for (int i = 1; i < 5; ++i) world.step(i);
  (void)world.take();
  world.send("T.startTime", SFTime{1004});
  CHECK(world.take() == Lines{"4 T.startTime 1004", "4 T.isActive TRUE", "4 T.cycleTime 1004", "4 T.fraction_changed 0",
                              "4 T.time 1004"});
}

TEST_CASE("sends all outputs and then isActive FALSE on set_enabled FALSE (6.50)") {
  World world(
      "DEF T TimeSensor { startTime 1001 cycleInterval 4 loop TRUE } DEF L DirectionalLight { } "
      "DEF S TimeSensor { startTime 1003 cycleInterval 9 } DEF Off DirectionalLight { on TRUE } "
      "ROUTE Off.on TO T.enabled");
  world.start();
  world.step(1);
  (void)world.take();
  world.send_at(3, "Off.on", false);
  CHECK(world.take("T.") ==
        Lines{"3 T.fraction_changed 0.5", "3 T.time 1003", "3 T.enabled FALSE", "3 T.isActive FALSE"});
}

TEST_CASE("accepts and sends exposedField events while disabled (6.50)") {
  World world("DEF T TimeSensor { enabled FALSE loop TRUE }");
  world.start();
  world.send("T.startTime", SFTime{1003});
  world.send("T.stopTime", SFTime{1002});
  world.send("T.cycleInterval", SFTime{7});
  world.send("T.loop", false);
  CHECK(world.take() == Lines{"0 T.startTime 1003", "0 T.stopTime 1002", "0 T.cycleInterval 7", "0 T.loop FALSE"});
  CHECK(world.take_at(3).empty());
}

TEST_CASE("sends cycleTime at the beginning of each cycle, also of the first (6.50)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  for (int i = 1; i < 16; ++i) world.step(i / 2.0);
  CHECK(world.take("cycleTime") ==
        Lines{"1 T.cycleTime 1001", "3 T.cycleTime 1003", "5 T.cycleTime 1005", "7 T.cycleTime 1007"});
}

TEST_CASE("sends fraction_changed 0 at startTime, 1 at the end of each cycle, and increasing values between (6.50)") {
  World world("DEF T TimeSensor { startTime 1001 cycleInterval 2 loop TRUE }");
  world.start();
  for (int i = 2; i < 11; ++i) world.step(i / 2.0);
  CHECK(world.take("fraction") ==
        Lines{"1 T.fraction_changed 0", "1.5 T.fraction_changed 0.25", "2 T.fraction_changed 0.5",
              "2.5 T.fraction_changed 0.75", "3 T.fraction_changed 1", "3.5 T.fraction_changed 0.25",
              "4 T.fraction_changed 0.5", "4.5 T.fraction_changed 0.75", "5 T.fraction_changed 1"});
}

TEST_CASE("applies set_cycleInterval while the sensor is inactive (6.50)") {
  World world("DEF T TimeSensor { startTime 1002 cycleInterval 2 }");
  world.start();
  world.send("T.cycleInterval", SFTime{4});
  world.send_at(2, "T.cycleInterval", SFTime{1});
  (void)world.take();
  CHECK(world.take_at(3) == Lines{"3 T.fraction_changed 0.25", "3 T.time 1003"});
}

}  // namespace gs::vrml::traces
