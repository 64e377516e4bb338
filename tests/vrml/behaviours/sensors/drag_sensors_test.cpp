#include "tests/vrml/events/pointer.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace gs::vrml::traces {
namespace {

constexpr float kNoFloat = std::numeric_limits<float>::quiet_NaN();
constexpr float kEndless = std::numeric_limits<float>::infinity();
constexpr double kHalfTurn = std::numbers::pi;

// Returns the number after the last blank of the last line that contains `part`.
double last_number(const Lines& lines, std::string_view part) {
  double result = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& line : lines)
    if (line.find(part) != std::string::npos) result = std::stod(line.substr(line.rfind(' ')));
  return result;
}

}  // namespace

TEST_CASE("maps a drag to a translation of a PlaneSensor, and adds drags up if autoOffset is TRUE (4.6.7.4, 6.34)") {
  World world("Transform { translation 1 0 0 scale 2 2 1 children [ DEF S Shape { } DEF P PlaneSensor { } ] }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.move("S", 3, 0);
  device.press();
  CHECK(world.take() == Lines{"1 P.isActive TRUE"});
  world.step(2);
  device.move("S", 5, 2);
  CHECK(world.take() == Lines{"2 P.trackPoint_changed 2 1 0", "2 P.translation_changed 1 1 0"});
  world.step(3);
  device.tell();  // no movement
  CHECK(world.take().empty());
  device.release("", 7, 0);
  CHECK(world.take() == Lines{"3 P.trackPoint_changed 3 0 0", "3 P.translation_changed 2 0 0", "3 P.isActive FALSE",
                              "3 P.offset 2 0 0"});
  world.step(4);
  device.press("S", 1, 0);
  world.step(5);
  device.release();  // without movement
  CHECK(world.take() == Lines{"4 P.isActive TRUE", "5 P.isActive FALSE"});
  world.send("P.autoOffset", false);
  world.step(6);
  device.press();
  world.step(7);
  device.move("S", 3, 0);
  world.step(8);
  device.release();
  CHECK(world.take("P.") == Lines{"5 P.autoOffset FALSE", "6 P.isActive TRUE", "7 P.trackPoint_changed 1 0 0",
                                  "7 P.translation_changed 3 0 0", "8 P.isActive FALSE"});
}

TEST_CASE("clamps the translation, not the track point, if minPosition is below maxPosition (6.34)") {
  World world(
      "Group { children [ DEF S Shape { } DEF P PlaneSensor { minPosition 0 -5 maxPosition 2 -5 offset 0.5 0 7 } ] } "
      "Group { children [ DEF R Shape { } DEF Q PlaneSensor { minPosition 1 0 maxPosition 0 1 } ] }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.press("S", 0, 0);
  world.step(2);
  device.move("S", 9, 3);
  CHECK(world.take("_changed") == Lines{"2 P.trackPoint_changed 9 3 0", "2 P.translation_changed 2 -5 7"});
  world.step(3);
  device.release("S", -9, 3);
  CHECK(world.take("P.offset") == Lines{"3 P.offset 0 -5 7"});
  world.step(4);
  device.press("R", 0, 0);
  world.step(5);
  device.move("R", -9, 3);
  CHECK(world.take("translation") == Lines{"5 Q.translation_changed -9 1 0"});
}

TEST_CASE("follows a drag in the coordinate system that the sensor had at the start of the drag (6.15)") {
  World world(
      "DEF M Transform { children [ DEF S Shape { } DEF P PlaneSensor { } ] } "
      "ROUTE P.translation_changed TO M.translation");
  world.start();
  PointingDevice device(world);
  device.press("S", 0, 0);
  for (int i = 1; i < 4; ++i) {
    world.step(i);
    device.move("S", i, 0);
  }
  CHECK(world.take("P.translation").back() == "3 P.translation_changed 3 0 0");
  CHECK(world.scene().get<SFVec3f>(world.node("M"), "translation") == SFVec3f(3, 0, 0));
  world.step(4);
  device.release();
  world.step(5);
  device.press("S", 3, 0);
  world.step(6);
  device.move("S", 4, 0);
  CHECK(world.take("P.").back() == "6 P.translation_changed 4 0 0");
}

TEST_CASE("keeps the last translation while the bearing misses the plane (6.34)") {
  World world("DEF S Shape { } DEF P PlaneSensor { }");
  world.start();
  PointingDevice device(world);
  device.press("S", 0, 0);
  world.step(1);
  device.move("S", 1, 0);
  (void)world.take();
  const glm::dvec3 directions[] = {{1, 0, 0}, {0, 1, 1}, {0, 0, 0}, {kNoFloat, 0, -1}, {1e30, 0, -1e-30}};
  for (const glm::dvec3& direction : directions) {
    world.step(world.execution().now() + 1 - World::kStart);
    device.bearing().direction = direction;
    device.tell();
  }
  CHECK(world.take().empty());
  world.step(20);
  device.release();
  CHECK(world.take() == Lines{"20 P.isActive FALSE", "20 P.offset 1 0 0"});
}

TEST_CASE("turns a CylinderSensor with its cylinder when it is viewed from the side (6.15)") {
  World world("Transform { translation 5 0 -1 children [ DEF S Shape { } DEF C CylinderSensor { offset 1 } ] }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.press("S", 5, 0);  // on the cylinder of radius 1, at its angle 0
  CHECK(world.take() == Lines{"1 C.isActive TRUE"});
  world.step(2);
  device.move("", 6, 3);  // on its edge
  const Lines moved = world.take();
  REQUIRE(moved.size() == 2);
  CHECK(moved[0] == "2 C.trackPoint_changed 1 3 0");
  CHECK(moved[1].starts_with("2 C.rotation_changed 0 1 0 2.570796"));
  world.step(3);
  device.move("", 6.5, 0);  // past the edge
  CHECK(world.take().empty());
  world.step(4);
  device.release("", 5, 1);
  CHECK(world.take() ==
        Lines{"4 C.trackPoint_changed 0 1 1", "4 C.rotation_changed 0 1 0 1", "4 C.isActive FALSE", "4 C.offset 1"});
}

TEST_CASE("chooses between cylinder and disk behaviour of a CylinderSensor by diskAngle (6.15)") {
  // The viewer looks along the axis from above, at a point at distance 1 from it.
  World world("DEF S Shape { } DEF C CylinderSensor { }");
  world.start();
  PointingDevice device(world);
  const glm::dvec3 down(0, -1, 0);
  device.at("S", {0, 2, 1}, down);
  device.press();
  const auto turn_to = [&](double angle) {
    world.step(world.execution().now() + 1 - World::kStart);
    device.at("", {2 * std::sin(angle), 2, 2 * std::cos(angle)}, down);
    device.tell();
    return last_number(world.take(), "rotation_changed");
  };
  CHECK(turn_to(kHalfTurn / 2) == Approx(kHalfTurn / 2));
  // Angles add up over full turns.
  CHECK(turn_to(kHalfTurn) == Approx(kHalfTurn));
  CHECK(turn_to(1.5 * kHalfTurn) == Approx(1.5 * kHalfTurn));
  CHECK(turn_to(2.25 * kHalfTurn) == Approx(2.25 * kHalfTurn));
  CHECK(turn_to(1.5 * kHalfTurn) == Approx(1.5 * kHalfTurn));
  world.send("C.minAngle", SFFloat{-1});
  world.send("C.maxAngle", SFFloat{4});
  (void)world.take();
  CHECK(turn_to(1.75 * kHalfTurn) == Approx(4));
  CHECK(turn_to(kHalfTurn) == Approx(kHalfTurn));
  // On the axis, the sensor sends a track point, but no angle.
  world.step(100);
  device.at("", {0, 2, 0}, down);
  device.tell();
  CHECK(world.take() == Lines{"100 C.trackPoint_changed 0 2 0"});
  world.step(101);
  device.release();
  CHECK(last_number(world.take(), "C.offset") == Approx(kHalfTurn));
  // The bearing is outside of diskAngle, so the sensor uses the cylinder, which the bearing never meets.
  world.send("C.diskAngle", SFFloat{0});
  world.step(102);
  device.at("S", {0, 2, 1}, down);
  device.press();
  (void)world.take();
  CHECK(std::isnan(turn_to(1)));
}

TEST_CASE("drags a CylinderSensor and a SphereSensor also from inside (6.15, 6.44)") {
  World world("DEF S Shape { } DEF C CylinderSensor { } DEF B SphereSensor { }");
  world.start();
  PointingDevice device(world);
  // The viewer is in the middle of a room.
  const auto look = [&](double angle) {
    const glm::dvec3 direction(std::sin(angle), 0, -std::cos(angle));
    device.at("S", direction * 4.0, direction);
    device.bearing().origin = {0, 0, 0};
  };
  look(0);
  device.press();
  world.step(1);
  look(0.5);
  device.tell();
  const Lines moved = world.take();
  CHECK(last_number(moved, "C.rotation_changed") == Approx(-0.5));
  CHECK(last_number(moved, "B.rotation_changed") == Approx(0.5));  // about 0 -1 0
}

TEST_CASE("turns a SphereSensor from the first point to the current one, after its offset (6.44)") {
  World world("Transform { translation 0 0 -2 children [ DEF S Shape { } DEF B SphereSensor { } ] }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.press("S", 0, 0);  // radius 2
  world.step(2);
  device.move("", 2, 0);
  const Lines right = world.take("_changed");
  REQUIRE(right.size() == 2);
  CHECK(right[0] == "2 B.trackPoint_changed 2 0 0");
  CHECK(right[1].starts_with("2 B.rotation_changed 0 1 0 1.570796"));
  world.step(3);
  device.move("", 0, 2.1);  // past the edge
  CHECK(world.take().empty());
  device.release();
  CHECK(last_number(world.take(), "B.offset") == Approx(kHalfTurn / 2));
  // The sphere turns by a quarter about Y, then by a quarter about -X. The point on the z axis moves to the x axis and
  // stays there.
  world.step(4);
  device.press("S", 0, 0);
  world.step(5);
  device.move("", 0, 2);
  const Lines up = world.take("rotation_changed");
  REQUIRE(up.size() == 1);
  const std::string third = "0.57735";
  CHECK(up[0].starts_with("5 B.rotation_changed -" + third));
  CHECK(up[0].find(' ' + third) != std::string::npos);
  CHECK(last_number(up, "rotation") == Approx(2 * kHalfTurn / 3));
  world.step(6);
  device.move("", 0, 0);
  CHECK(world.take("rotation").back().starts_with("6 B.rotation_changed 0 1 0 1.57"));
}

TEST_CASE("sends isActive FALSE and keeps the offset when a drag sensor is disabled while active (6.34)") {
  World world("DEF S Shape { } DEF P PlaneSensor { } DEF B SphereSensor { } DEF C CylinderSensor { }");
  world.start();
  PointingDevice device(world);
  device.press("S", 0, 1);
  world.step(1);
  device.move("S", 1, 0);
  (void)world.take();
  for (const char* sensor : {"P", "B", "C"}) world.send(std::string(sensor) + ".enabled", false);
  CHECK(world.take("isActive") == Lines{"1 P.isActive FALSE", "1 B.isActive FALSE", "1 C.isActive FALSE"});
  world.step(2);
  device.move("S", 2, 0);
  world.step(3);
  device.release();
  CHECK(world.take().empty());
  CHECK(world.scene().get<SFVec3f>(world.node("P"), "offset") == SFVec3f(0));
}

TEST_CASE("sends no NaN from drag sensors with singular coordinate systems or fields (4.6.7.4)") {
  World world(R"(Transform { scale 1 0 1 children [ DEF S Shape { }
      DEF P PlaneSensor { } DEF B SphereSensor { } DEF C CylinderSensor { } ] }
    DEF R Shape { } DEF P2 PlaneSensor { } DEF B2 SphereSensor { } DEF C2 CylinderSensor { })");
  world.start();
  PointingDevice device(world);
  device.press("S", 1, 0);
  world.step(1);
  device.move("S", 2, 0);
  CHECK(world.take("_changed").empty());
  world.step(2);
  device.release();
  CHECK(world.take("isActive").size() == 3);
  const SFVec3f nowhere(kNoFloat, kEndless, 0);
  world.send("P2.offset", nowhere);
  world.send("P2.minPosition", SFVec2f(kNoFloat, -kEndless));
  world.send("C2.offset", kNoFloat);
  world.send("C2.diskAngle", kNoFloat);
  world.send("C2.minAngle", kNoFloat);
  world.send("B2.offset", SFRotation{0, 0, 0, kEndless});
  world.step(3);
  device.press("R", 0, 0);  // the origin: neither cylinder nor sphere
  world.step(4);
  device.move("R", 1, 0);
  CHECK(world.take("_changed") == Lines{"4 P2.trackPoint_changed 1 0 0"});
  world.step(5);
  device.release();
  CHECK(world.take("offset").empty());
  world.step(6);
  device.at("R", {0, 0, 1}, {0, 0, -1});
  device.press();
  world.step(7);
  device.at("R", {1, 0, 0}, {0, 0, -1});
  device.tell();
  const Lines sent = world.take("rotation_changed");
  REQUIRE(sent.size() == 1);
  CHECK(sent[0].starts_with("7 B2.rotation_changed 0 1 0 1.57"));
}

}  // namespace gs::vrml::traces
