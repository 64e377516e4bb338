#include "tests/vrml/events/trace.h"

#include <cmath>
#include <numbers>
#include <string>

// Tests of chasers and dampers (X3D clause 39).
namespace gs::vrml::traces {
namespace {

// Steps to a time, and returns the last number of value_changed of F. Returns NaN if F sends none.
double number_sent(World& world, double at) {
  const Lines lines = world.take_at(at, "F.value_changed");
  return lines.size() == 1 ? std::stod(lines[0].substr(lines[0].rfind(' ') + 1)) : std::nan("");
}

double step_response(double part) { return 0.5 - 0.5 * std::cos(part * std::numbers::pi); }

}  // namespace

TEST_CASE("reaches the destination of a chaser after its duration, then rests (X3D 39.3.1)") {
  X3DWorld world("DEF F ScalarChaser { duration 4 }");
  world.start();
  CHECK_FALSE(world.execution().next_time());
  world.send_at(1, "F.set_destination", SFFloat{8});
  CHECK(world.take() == Lines{"1 F.isActive TRUE"});
  CHECK(number_sent(world, 2) == Approx(8 * step_response(0.25)));
  CHECK(number_sent(world, 3) == Approx(4));
  CHECK(world.take_at(5) == Lines{"5 F.value_changed 8", "5 F.isActive FALSE"});
  CHECK(world.take_at(6).empty());
  CHECK_FALSE(world.execution().next_time());
}

TEST_CASE("adds the responses to the destinations of a chaser during its duration (X3D 39.3.1)") {
  X3DWorld world("DEF F ScalarChaser { duration 4 }");
  world.start();
  world.send_at(1, "F.set_destination", SFFloat{8});
  world.send_at(3, "F.set_destination", SFFloat{0});
  (void)world.take();
  CHECK(number_sent(world, 4) == Approx(8 * step_response(0.75) - 8 * step_response(0.25)));
  CHECK(number_sent(world, 5) == Approx(8 - 4));
  (void)world.take();
  CHECK(world.take_at(7) == Lines{"7 F.value_changed 0", "7 F.isActive FALSE"});
}

TEST_CASE("jumps to set_value, and then moves to the destination again (X3D 39.3.3)") {
  X3DWorld world("DEF F ScalarChaser { duration 2 initialValue 4 initialDestination 4 }");
  world.start();
  CHECK(world.take_at(1).empty());
  world.send_at(2, "F.set_value", SFFloat{0});
  CHECK(world.take() == Lines{"2 F.value_changed 0", "2 F.isActive TRUE"});
  CHECK(number_sent(world, 3) == Approx(2));
  CHECK(world.take_at(4) == Lines{"4 F.value_changed 4", "4 F.isActive FALSE"});
}

TEST_CASE("begins a transition at the start if initialValue and initialDestination differ (X3D 39.3.3)") {
  X3DWorld chaser("DEF F PositionChaser { initialDestination 2 0 0 }");
  chaser.start();
  CHECK(chaser.take() == Lines{"0 F.isActive TRUE"});
  CHECK(chaser.take_at(0.5) == Lines{"0.5 F.value_changed 1 0 0"});
  X3DWorld damper("DEF F PositionDamper2D { initialDestination 2 0 order 1 tau 1 }");
  damper.start();
  CHECK(damper.take() == Lines{"0 F.isActive TRUE"});
}

TEST_CASE("approaches the destination of a damper by its order and tau (X3D 39.3.2)") {
  X3DWorld first("DEF F ScalarDamper { order 1 tau 2 }"), none("DEF F ScalarDamper { order 0 tau 2 }"),
      second("DEF F ScalarDamper { order 2 tau 2 }");
  for (X3DWorld* world : {&first, &none, &second}) {
    world->start();
    world->send_at(1, "F.set_destination", SFFloat{1});
  }
  const double kept = std::exp(-0.5);
  CHECK(number_sent(first, 2) == Approx(1 - kept));
  CHECK(number_sent(first, 3) == Approx(1 - kept * kept));
  CHECK(number_sent(none, 2) == Approx(1));
  CHECK(number_sent(second, 2) == Approx((1 - kept) * (1 - kept)));
}

TEST_CASE("ends the transition of a damper within its tolerance, at the destination (X3D 39.3.2)") {
  X3DWorld world("DEF F ScalarDamper { order 1 tau 1 tolerance 0.2 }");
  world.start();
  world.send_at(1, "F.set_destination", SFFloat{1});
  (void)world.take();
  CHECK(number_sent(world, 2) == Approx(1 - std::exp(-1)));
  CHECK(world.take_at(3) == Lines{"3 F.value_changed 1", "3 F.isActive FALSE"});
  CHECK_FALSE(world.execution().next_time());
  CHECK(world.take_at(4).empty());
}

TEST_CASE("follows orientations, colours and lists of points (X3D 39.4)") {
  X3DWorld turn("DEF F OrientationChaser { duration 2 }");
  turn.start();
  turn.send_at(1, "F.set_destination", SFRotation{0, 1, 0, 1});
  const Lines turned = turn.take_at(2, "value_changed");
  REQUIRE(turned.size() == 1);
  CHECK(turned[0].starts_with("2 F.value_changed 0 1 0 0.5"));
  X3DWorld color("DEF F ColorChaser { duration 2 initialValue 0 0 0 initialDestination 0 0 0 }");
  color.start();
  color.send_at(1, "F.set_destination", SFColor{1, 0.5F, 0});
  CHECK(color.take_at(2, "value_changed") == Lines{"2 F.value_changed 0.5 0.375 0.25"});
  X3DWorld list("DEF F CoordinateChaser { duration 2 initialValue [ 0 0 0 ] initialDestination [ 0 0 0 ] }");
  list.start();
  list.send_at(1, "F.set_destination", MFVec3f{SFVec3f(2, 0, 0), SFVec3f(0, 0, 6)});
  CHECK(list.take_at(2, "value_changed") == Lines{"2 F.value_changed [ 1 0 0, 0 0 6 ]"});
  CHECK(list.take_at(3, "value_changed") == Lines{"3 F.value_changed [ 2 0 0, 0 0 6 ]"});
}

TEST_CASE("moves colours of followers in HSV, with the hue on the shorter way (X3D 39.4)") {
  X3DWorld chaser("DEF F ColorChaser { duration 2 initialValue 1 0 0 initialDestination 1 0 0 }");
  chaser.start();
  chaser.send_at(1, "F.set_destination", SFColor{0, 0, 1});
  CHECK(chaser.take_at(2, "value_changed") == Lines{"2 F.value_changed 1 0 1"});
  chaser.step(2.5);
  CHECK(chaser.take_at(3.5, "value_changed").back() == "3.5 F.value_changed 0 0 1");
  X3DWorld damper("DEF F ColorDamper { tau 1 order 1 tolerance 0.01 initialValue 1 0 0 initialDestination 1 0 0 }");
  damper.start();
  damper.send_at(1, "F.set_destination", SFColor{0, 1, 0});
  CHECK(damper.take_at(1 + std::log(2.0), "value_changed").back().find(" F.value_changed 1 1 0") != std::string::npos);
  CHECK(damper.take_at(20, "value_changed").back() == "20 F.value_changed 0 1 0");
}

TEST_CASE("keeps a chaser bounded when each step sends a destination (X3D 39.3.1)") {
  X3DWorld world("DEF F ScalarChaser { duration 1000 }");
  world.start();
  for (int i = 1; i < 2000; ++i) world.send_at(i * 0.5, "F.set_destination", SFFloat(static_cast<float>(i)));
  CHECK(world.execution().budget().problem().empty());
}

TEST_CASE("sends the destination at once if the duration or tau is 0 (X3D 39.3)") {
  X3DWorld chaser("DEF F ScalarChaser { duration 0 }"), damper("DEF F ScalarDamper { tau 0 }");
  for (X3DWorld* world : {&chaser, &damper}) {
    world->start();
    world->send_at(1, "F.set_destination", SFFloat{3});
    (void)world->take();
    CHECK(world->take_at(2) == Lines{"2 F.value_changed 3", "2 F.isActive FALSE"});
  }
}

}  // namespace gs::vrml::traces
