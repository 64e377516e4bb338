#include "tests/vrml/events/trace.h"

#include <glm/gtc/matrix_transform.hpp>

#include <limits>
#include <string>

namespace gs::vrml::traces {
namespace {

glm::dmat4 viewer_at(double x, double y, double z) { return glm::translate(glm::dmat4(1), {x, y, z}); }

}  // namespace

TEST_CASE("reports entry, movement and exit of the viewer by a ProximitySensor (6.38)") {
  World world(
      "Transform { translation 100 0 0 scale 2 2 2 children DEF P ProximitySensor { size 2 2 2 } } "
      "DEF Zero ProximitySensor { center 0 0 10 }");
  world.start();
  CHECK(world.take().empty());  // the viewer is at 0 0 10
  world.execution().viewer().set(viewer_at(101, 0, 0));
  CHECK(world.take_at(1) == Lines{"1 P.isActive TRUE", "1 P.enterTime 1001", "1 P.position_changed 0.5 0 0",
                                  "1 P.orientation_changed 0 0 1 0"});
  CHECK(world.take_at(2).empty());
  world.execution().viewer().set(viewer_at(102, 1, 0));
  CHECK(world.take_at(3) == Lines{"3 P.position_changed 1 0.5 0"});
  world.execution().viewer().set(viewer_at(103, 0, 0));
  world.step(4);
  // The straight path leads out of the box in the same step.
  CHECK(world.take() == Lines{"4 P.isActive FALSE", "4 P.exitTime 1003", "4 P.position_changed 1 0.5 0",
                              "4 P.orientation_changed 0 0 1 0"});
}

TEST_CASE("moves the viewer with the bound Viewpoint, with its Transform and into a ProximitySensor") {
  World world(
      "Viewpoint { } DEF T Transform { rotation 0 1 0 1.5707963 children DEF V Viewpoint { position 1 0 0 } } "
      "DEF P ProximitySensor { size 8 8 8 }");
  world.start();
  (void)world.take();
  world.send_at(1, "V.set_bind", true);
  const Lines entered = world.take("P.");
  REQUIRE(entered.size() == 4);
  CHECK(entered[0] == "1 P.isActive TRUE");
  CHECK(entered[3].find("P.orientation_changed 0 1 0 1.570796") != std::string::npos);
  CHECK(world.scene().get<SFVec3f>(world.node("T"), "translation") == SFVec3f(0));
  world.send("T.translation", SFVec3f(0, 0, 100));
  CHECK(world.take_at(3, "isActive") == Lines{"3 P.isActive FALSE"});
}

TEST_CASE("handles a ProximitySensor with several instances, disabled, or with negative sizes") {
  World world(
      "Transform { translation 50 0 0 children DEF P ProximitySensor { size 2 2 2 } } "
      "Transform { translation -50 0 0 children USE P } DEF N ProximitySensor { size 1 1 1 }");
  world.start();
  world.execution().viewer().set(viewer_at(-50, 0, 0));
  CHECK(world.take_at(1, "P.isActive") == Lines{"1 P.isActive TRUE"});
  world.send_at(2, "P.enabled", false);
  CHECK(world.take() == Lines{"2 P.enabled FALSE", "2 P.isActive FALSE", "2 P.exitTime 1002"});
  CHECK(world.take_at(3).empty());
  world.send("P.enabled", true);
  CHECK(world.take("P.isActive") == Lines{"3 P.isActive TRUE"});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  world.send("N.size", SFVec3f(nan, 1, std::numeric_limits<float>::infinity()));
  world.send("P.center", SFVec3f(nan, nan, nan));
  CHECK(world.take_at(4, "isActive") == Lines{"4 P.isActive FALSE"});
}

TEST_CASE("survives cyclic hierarchies and exponentially many instances of a ProximitySensor") {
  std::string text = "DEF G Group { children DEF P ProximitySensor { size 1 1 1 } } DEF H0 Group { children USE G }";
  for (int i = 1; i < 40; ++i)
    text += " DEF H" + std::to_string(i) + " Group { children [ USE H" + std::to_string(i - 1) + " USE H" +
            std::to_string(i - 1) + " ] }";
  Limits limits;
  limits.visits = 100'000;
  World world(text, limits);
  world.start();
  world.send("G.addChildren", MFNode{world.node("G"), world.node("H3")});
  world.execution().viewer().set(viewer_at(0, 0, 0));
  CHECK(world.take_at(1, "P.isActive") == Lines{"1 P.isActive TRUE"});
}

TEST_CASE("evaluates nested ProximitySensors independently, and none below an unselected Switch choice (6.38, 6.46)") {
  World world(
      "Switch { whichChoice -1 choice DEF P ProximitySensor { size 4 4 4 } } DEF Q ProximitySensor { size 8 8 8 } "
      "DEF Off ProximitySensor { size 8 8 8 enabled FALSE } DEF Flat ProximitySensor { size 8 0 8 }");
  world.start();
  world.execution().viewer().set(viewer_at(3, 0, 0));
  CHECK(world.take_at(1, "isActive") == Lines{"1 Q.isActive TRUE"});
  world.execution().viewer().set(viewer_at(1, 0, 0));
  CHECK(world.take_at(2, "isActive") == Lines{"2 P.isActive TRUE"});
  world.execution().viewer().set(viewer_at(9, 0, 0));
  CHECK(world.take_at(3, "Time") == Lines{"3 P.exitTime 1002.125", "3 Q.exitTime 1002.375"});
}

TEST_CASE("reports a viewer at rest when the ProximitySensor moves (6.38)") {
  World world(
      "DEF T Transform { translation 50 0 0 children DEF P ProximitySensor { size 4 4 4 } } Viewpoint { position 0 0 0 "
      "}");
  world.start();
  world.step(1);
  (void)world.take();
  world.send("T.translation", SFVec3f(1, 0, 0));
  CHECK(world.take_at(2, "P.") == Lines{"2 P.isActive TRUE", "2 P.enterTime 1002", "2 P.position_changed -1 0 0",
                                        "2 P.orientation_changed 0 0 1 0"});
  world.send("P.center", SFVec3f(5, 0, 0));
  CHECK(world.take_at(3, "P.isActive") == Lines{"3 P.isActive FALSE"});
  world.send("P.size", SFVec3f(20, 4, 4));
  CHECK(world.take_at(4, "P.isActive") == Lines{"4 P.isActive TRUE"});
}

TEST_CASE("sends enterTime at the start of the world from a ProximitySensor around everything (6.38)") {
  World world(
      "DEF P ProximitySensor { size 1000 1000 1000 } DEF T TimeSensor { cycleInterval 4 } "
      "ROUTE P.enterTime TO T.startTime");
  world.start();
  CHECK(world.take("P.enterTime") == Lines{"0 P.enterTime 1000"});
  CHECK(world.take_at(1, "T.fraction") == Lines{"1 T.fraction_changed 0.25"});
}

TEST_CASE("sends position and orientation from a ProximitySensor only when they change (6.38)") {
  World world("DEF P ProximitySensor { size 10 10 10 }");
  world.start();
  world.execution().viewer().set(viewer_at(1, 0, 0));
  world.step(1);
  (void)world.take();
  world.execution().viewer().set(glm::rotate(viewer_at(1, 0, 0), 0.5, glm::dvec3(0, 1, 0)));
  CHECK(world.take_at(2) == Lines{"2 P.orientation_changed 0 1 0 0.5"});
  world.execution().viewer().set(glm::rotate(viewer_at(2, 0, 0), 0.5, glm::dvec3(0, 1, 0)));
  CHECK(world.take_at(3) == Lines{"3 P.position_changed 2 0 0"});
}

TEST_CASE("reports the times and positions at which the viewer crossed the box of a ProximitySensor (6.38)") {
  World world("DEF P ProximitySensor { size 2 2 2 }");
  world.execution().viewer().set(viewer_at(5, 0, 0));
  world.start();
  // A path through the whole box in one step needs two timestamps.
  world.execution().viewer().set(viewer_at(-3, 0, 0));
  CHECK(world.take_at(1) == Lines{"1 P.isActive TRUE", "1 P.enterTime 1000.5", "1 P.position_changed 1 0 0",
                                  "1 P.orientation_changed 0 0 1 0"});
  CHECK(world.take_at(2) == Lines{"2 P.isActive FALSE", "2 P.exitTime 1000.75", "2 P.position_changed -1 0 0",
                                  "2 P.orientation_changed 0 0 1 0"});
  CHECK(world.take_at(3).empty());
  world.execution().viewer().set(viewer_at(1, 0, 0));
  CHECK(world.take_at(4) == Lines{"4 P.isActive TRUE", "4 P.enterTime 1003.5", "4 P.position_changed 1 0 0",
                                  "4 P.orientation_changed 0 0 1 0"});
  world.execution().viewer().set(viewer_at(-7, 0, 0));
  CHECK(world.take_at(5) == Lines{"5 P.isActive FALSE", "5 P.exitTime 1004.25", "5 P.position_changed -1 0 0",
                                  "5 P.orientation_changed 0 0 1 0"});
  // The paths pass a corner, and come from an invalid position.
  world.execution().viewer().set(viewer_at(0, 7.5, 0));
  world.step(6);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  world.execution().viewer().set(viewer_at(nan, 0, 0));
  world.step(7);
  world.execution().viewer().set(viewer_at(9, 0, 0));
  CHECK(world.take_at(8).empty());
  // A return before the exit was sent keeps the viewer in the box.
  world.execution().viewer().set(viewer_at(-9, 0, 0));
  world.step(9);
  world.execution().viewer().set(viewer_at(0, 0, 0));
  CHECK(world.take_at(10, "isActive") == Lines{"9 P.isActive TRUE"});
  world.execution().viewer().set(viewer_at(9, 0, 0));
  world.step(11);
  world.execution().viewer().set(viewer_at(-9, 0, 0));
  world.step(12);
  (void)world.take();
  world.send("P.enabled", false);
  CHECK(world.take_at(13, "exitTime") == Lines{"13 P.exitTime 1013"});
}

TEST_CASE("does not trigger a ProximitySensor between two Viewpoints on a jump (6.53)") {
  World world(
      "DEF P ProximitySensor { size 2 2 2 } DEF V Viewpoint { position 5 0 0 } DEF M Transform { children DEF W "
      "Viewpoint { position -5 0 0 } }");
  world.start();
  world.send_at(1, "W.set_bind", true);
  CHECK(world.take_at(2, "P.").empty());
  // A moving Viewpoint moves the viewer.
  world.send("M.translation", SFVec3f(10, 0, 0));
  CHECK(world.take_at(3, "P.isActive") == Lines{"3 P.isActive TRUE"});
  CHECK(world.take_at(4, "P.exitTime") == Lines{"4 P.exitTime 1002.6"});
  // The window reports the new position in the step after the jump.
  world.execution().viewer().set(viewer_at(5, 0, 0));
  world.send_at(5, "V.set_bind", true);
  world.execution().viewer().set(viewer_at(-5, 0, 0));
  CHECK(world.take_at(6, "P.").empty());
  world.execution().viewer().set(viewer_at(5, 0, 0));
  CHECK(world.take_at(7, "P.enterTime") == Lines{"7 P.enterTime 1006.4"});
}

TEST_CASE("turns a ProximitySensor below a Billboard towards the viewer (6.6, 6.38)") {
  World world(R"(Transform { translation 1 0 0 children Billboard { children
      Transform { translation 0 0 5 children DEF P ProximitySensor { size 2 2 2 } } } }
    DEF Still Transform { translation 0 0 5 children ProximitySensor { size 2 2 2 } }
    Billboard { children [ DEF V Viewpoint { position 0 0 50 } DEF Q ProximitySensor { center 0 0 50 size 1 1 1 } ] })");
  world.start();
  CHECK(world.take("isActive") == Lines{"0 Q.isActive TRUE"});
  world.execution().viewer().set(viewer_at(6, 0, 0));
  CHECK(world.take_at(1, "isActive") == Lines{"1 P.isActive TRUE", "1 Q.isActive FALSE"});
  world.execution().viewer().set(viewer_at(1, 0, -5.5));
  CHECK(world.take_at(2, "isActive").empty());
  world.execution().viewer().set(viewer_at(1, 0, -7));
  CHECK(world.take_at(3, "isActive") == Lines{"3 P.isActive FALSE"});
}

}  // namespace gs::vrml::traces
