#include "tests/vrml/events/pointer.h"

#include <string>

// Tests of the interfaces that X3D adds to pointing-device sensors (X3D clause 20).
namespace gs::vrml::traces {

TEST_CASE("sends isOver from drag sensors (X3D 20.3.1)") {
  for (const std::string type : {"PlaneSensor", "CylinderSensor", "SphereSensor"}) {
    INFO(type);
    X3DWorld world("Group { children [ DEF S Shape { } DEF P " + type + " { } ] }");
    world.start();
    PointingDevice device(world);
    world.step(1);
    device.move("S", 1, 0);
    CHECK(world.take() == Lines{"1 P.isOver TRUE"});
    world.step(2);
    device.move("", 5, 0);
    CHECK(world.take() == Lines{"2 P.isOver FALSE"});
  }
}

TEST_CASE("reports the description of a sensor under the pointer (X3D 20.3.1)") {
  X3DWorld world("Group { children [ DEF S Shape { } TouchSensor { description \"door\" } ] }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.move("S", 0, 0);
  CHECK(world.execution().pointing().pointed_at().description == "door");
}

TEST_CASE("turns the axes of a PlaneSensor by axisRotation (X3D 20.4.2)") {
  // The sensor's X axis is the Y axis of its group, so only movements along Y count.
  X3DWorld world(
      "Group { children [ DEF S Shape { } "
      "DEF P PlaneSensor { axisRotation 0 0 1 1.5707963 minPosition 0 0 maxPosition 4 0 } ] }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.press("S", 0, 0);
  (void)world.take();
  world.step(2);
  device.move("S", 3, 2);
  const Lines lines = world.take("translation_changed");
  REQUIRE(lines.size() == 1);
  const InterfaceDeclaration* event = world.scene().node(world.node("P")).type->find_event_out("translation_changed");
  const FieldValue* value = world.execution().cascade().last_value(world.scene(), world.node("P"), *event);
  REQUIRE(value);
  const SFVec3f translation = std::get<SFVec3f>(*value);
  CHECK(translation.x == Approx(0).margin(1e-5));
  CHECK(translation.y == Approx(2));
}

TEST_CASE("turns the axis of a CylinderSensor by axisRotation (X3D 20.4.1)") {
  // The axis of the cylinder is the X axis, so a drag along Y turns it.
  X3DWorld world(
      "Group { children [ DEF S Shape { } DEF C CylinderSensor { axisRotation 0 0 1 -1.5707963 diskAngle 0 } ] }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.at("S", {0, 0, 1}, {0, 0, -1});
  device.press();
  (void)world.take();
  world.step(2);
  device.at("S", {0, 0.5, 1}, {0, 0, -1});
  device.tell();
  const Lines lines = world.take("rotation_changed");
  REQUIRE(lines.size() == 1);
  const InterfaceDeclaration* event = world.scene().node(world.node("C")).type->find_event_out("rotation_changed");
  const FieldValue* value = world.execution().cascade().last_value(world.scene(), world.node("C"), *event);
  REQUIRE(value);
  const SFRotation turned = std::get<SFRotation>(*value);
  CHECK(turned.x == Approx(1));
  CHECK(turned.y == Approx(0).margin(1e-5));
  CHECK(turned.angle == Approx(-0.5235988).margin(1e-4));
}

}  // namespace gs::vrml::traces
