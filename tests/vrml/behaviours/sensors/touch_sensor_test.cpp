#include "tests/vrml/events/pointer.h"

#include <limits>

namespace gs::vrml::traces {
namespace {

constexpr double kNoDouble = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_CASE("reports the point under the pointer in the coordinate system of a TouchSensor (6.51)") {
  World world("Transform { translation 1 2 0 scale 2 2 4 children [ DEF S Shape { } DEF T TouchSensor { } ] }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.move("S", 2, 4);
  CHECK(world.take() == Lines{"1 T.isOver TRUE", "1 T.hitPoint_changed 0.5 1 0", "1 T.hitNormal_changed 0 0 1",
                              "1 T.hitTexCoord_changed 0.25 0.5"});
  world.step(2);
  device.tell();  // no movement
  CHECK(world.take().empty());
  device.move("S", 3, 4);
  CHECK(world.take() ==
        Lines{"2 T.hitPoint_changed 1 1 0", "2 T.hitNormal_changed 0 0 1", "2 T.hitTexCoord_changed 0.25 0.5"});
  world.step(3);
  device.move("", 9, 9);
  CHECK(world.take() == Lines{"3 T.isOver FALSE"});
  CHECK_FALSE(world.execution().pointing().pointed_at().sensor);
}

TEST_CASE("transforms a normal into the coordinate system of an unevenly scaled TouchSensor, with length 1 (6.51)") {
  World world("Transform { scale 1 2 1 children [ DEF S Shape { } DEF T TouchSensor { } ] }");
  world.start();
  PointingDevice device(world);
  device.at("S", 0, 0);
  device.bearing().normal = {3, 2, 0};
  device.tell();
  CHECK(world.take("hitNormal") == Lines{"0 T.hitNormal_changed 0.6 0.8 0"});
}

TEST_CASE("sends touchTime only if the button is released over the TouchSensor (6.51)") {
  World world("Group { children [ DEF S Shape { } DEF T TouchSensor { } ] } DEF Other Shape { }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.press("S", 0, 0);
  CHECK(world.take() == Lines{"1 T.isOver TRUE", "1 T.hitPoint_changed 0 0 0", "1 T.hitNormal_changed 0 0 1",
                              "1 T.hitTexCoord_changed 0.25 0.5", "1 T.isActive TRUE"});
  CHECK(world.execution().pointing().pointed_at().active);
  world.step(2);
  device.release();
  CHECK(world.take() == Lines{"2 T.isActive FALSE", "2 T.touchTime 1002"});
  world.step(3);
  device.press();
  world.step(4);
  device.move("Other", 5, 0);
  CHECK(world.take() == Lines{"3 T.isActive TRUE", "4 T.isOver FALSE"});
  world.step(5);
  device.release();
  CHECK(world.take() == Lines{"5 T.isActive FALSE"});
  // A press elsewhere and a release over the sensor is not a click.
  world.step(6);
  device.press();
  world.step(7);
  device.move("S", 1, 0);
  world.step(8);
  device.release();
  CHECK(world.take("T.isOver") == Lines{"7 T.isOver TRUE"});
  CHECK(world.take().empty());
  // The pointer moves away and back again.
  world.step(9);
  device.press();
  world.step(10);
  device.move("", 5, 0);
  world.step(11);
  device.release("S", 1, 0);
  CHECK(world.take("T.is") ==
        Lines{"9 T.isActive TRUE", "10 T.isOver FALSE", "11 T.isOver TRUE", "11 T.isActive FALSE"});
}

TEST_CASE("sends events when the pointer moves, not when geometry moves under it (6.51)") {
  World world("DEF M Transform { children [ DEF S Shape { } DEF T TouchSensor { } ] }");
  world.start();
  PointingDevice device(world);
  device.move("S", 0, 0);
  (void)world.take();
  world.step(1);
  device.path().clear();  // the shape is removed
  device.tell();
  CHECK(world.take().empty());
  CHECK(world.execution().pointing().pointed_at().sensor);
  world.step(2);
  device.press();  // the button evaluates the pointer again
  CHECK(world.take() == Lines{"2 T.isOver FALSE"});
}

TEST_CASE("sends only isOver FALSE and isActive FALSE when a TouchSensor is disabled (4.6.7.3, 6.51)") {
  World world("Group { children [ DEF S Shape { } DEF T TouchSensor { } ] }");
  world.start();
  PointingDevice device(world);
  device.press("S", 0, 0);
  (void)world.take();
  world.send_at(1, "T.enabled", false);
  CHECK(world.take() == Lines{"1 T.enabled FALSE", "1 T.isActive FALSE", "1 T.isOver FALSE"});
  device.move("S", 1, 0);
  CHECK(world.take().empty());
  // A sensor that is enabled while the button is down waits for its release.
  world.send_at(2, "T.enabled", true);
  device.move("S", 2, 0);
  world.step(3);
  device.release("S", 3, 0);
  CHECK(world.take() == Lines{"2 T.enabled TRUE"});
  world.step(4);
  device.move("S", 4, 0);
  CHECK(world.take("T.is") == Lines{"4 T.isOver TRUE"});
}

TEST_CASE("gives isActive TRUE and FALSE different timestamps, also if both happen at once (4.10.4)") {
  World world(
      "Group { children [ DEF S Shape { } DEF T TouchSensor { } ] } "
      "DEF Off TimeSensor { enabled FALSE } ROUTE Off.enabled TO T.enabled");
  world.start();
  PointingDevice device(world);
  device.move("S", 0, 0);
  world.step(1);
  (void)world.take();
  device.press();
  device.release();
  device.press();
  device.release();
  CHECK(world.take() == Lines{"1 T.isActive TRUE"});
  CHECK(world.execution().next_time() == World::kStart + 1);  // at the earliest time
  CHECK(world.take_at(2) == Lines{"2 T.isActive FALSE", "2 T.touchTime 1002"});
  world.step(3);
  CHECK(world.take_at(4) == Lines{"3 T.isActive TRUE", "4 T.isActive FALSE", "4 T.touchTime 1004"});
  world.step(5);
  device.press();
  world.send("Off.enabled", false);
  CHECK(world.take("T.") == Lines{"5 T.isActive TRUE", "5 T.enabled FALSE", "5 T.isOver FALSE"});
  CHECK(world.take_at(6) == Lines{"6 T.isActive FALSE"});
  CHECK(world.take_at(7).empty());
  CHECK_FALSE(world.execution().next_time());
  for (int i = 0; i < 1000; ++i) device.set(i % 2 == 0);
  for (int i = 8; i < 200; ++i) world.step(i);
  CHECK_FALSE(world.execution().pointing().pointed_at().active);
}

TEST_CASE("sends finite values from a TouchSensor in singular coordinate systems and for NaN input (6.51)") {
  World world(
      "Transform { scale 0 0 0 children [ DEF S Shape { } DEF T TouchSensor { } ] } DEF F Shape { } "
      "DEF G TouchSensor { }");
  world.start();
  PointingDevice device(world);
  device.move("S", 1, 0);
  CHECK(world.take() == Lines{"0 T.isOver TRUE", "0 T.hitTexCoord_changed 0.25 0.5"});
  world.step(1);
  device.at("F", 2, 0);
  device.bearing().point = glm::dvec3(1e300, 0, kNoDouble);
  device.bearing().normal = glm::dvec3(0);
  device.bearing().texture_coordinate = glm::dvec2(kNoDouble, 0);
  device.tell();
  CHECK(world.take() == Lines{"1 T.isOver FALSE", "1 G.isOver TRUE"});
}

}  // namespace gs::vrml::traces
