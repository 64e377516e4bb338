#include "vrml/events/idle_sensors.h"

#include "tests/vrml/events/trace.h"

#include <glm/gtc/matrix_transform.hpp>

#include <chrono>
#include <limits>
#include <random>
#include <string>

namespace gs::vrml::traces {
namespace {

glm::dmat4 viewer_place(double x, double y, double z) { return glm::translate(glm::dmat4(1), {x, y, z}); }

// Returns a sensor below so many Transforms that it never rests.
std::string wakeful(const std::string& name, const std::string& fields) {
  constexpr int kTransforms = 65;
  std::string text;
  for (int i = 0; i < kTransforms; ++i) text += "Transform { children ";
  text += "DEF " + name + " ProximitySensor { " + fields + " }";
  for (int i = 0; i < kTransforms; ++i) text += " }";
  return text;
}

// Returns the lines of one sensor, without its name.
Lines lines_of(const Lines& all, const std::string& name) {
  Lines some;
  for (std::string line : all)
    if (const std::size_t at = line.find(' ' + name + '.'); at != std::string::npos)
      some.push_back(line.erase(at + 1, name.size()));
  return some;
}

}  // namespace

TEST_CASE("lets sensors rest that the viewer is outside of") {
  World world(
      "DEF Near ProximitySensor { size 4 4 4 } Transform { translation 100 0 0 children DEF Far ProximitySensor { size "
      "4 "
      "4 4 } } DEF Off ProximitySensor { size 4 4 4 enabled FALSE } DEF Flat ProximitySensor { size 4 0 4 }");
  world.start();
  world.execution().viewer().set(viewer_place(0, 0, 0));
  world.step(1);
  world.step(2);
  CHECK(world.take("isActive") == Lines{"1 Near.isActive TRUE"});
  CHECK(world.execution().viewer().idle().count() == 1);
  CHECK(world.execution().next_time());  // the viewer may move in any step
  world.execution().viewer().set(viewer_place(100, 0, 0));
  world.step(3);
  CHECK(world.take("isActive") == Lines{"3 Near.isActive FALSE", "3 Far.isActive TRUE"});
  world.step(4);
  CHECK(world.execution().viewer().idle().count() == 1);
  world.execution().viewer().set(viewer_place(50, 0, 0));
  world.step(5);
  world.step(6);
  CHECK(world.execution().viewer().idle().count() == 2);
}

TEST_CASE("gives a resting sensor the exact times of the viewer's path (6.38)") {
  World world("DEF P ProximitySensor { size 2 2 2 }" + wakeful("Q", "size 2 2 2"));
  world.start();
  world.execution().viewer().set(viewer_place(10, 0, 0));
  for (int i = 1; i < 5; ++i) world.step(i);
  CHECK(world.execution().viewer().idle().count() == 1);
  world.execution().viewer().set(viewer_place(-10, 0, 0));
  world.step(5);  // passes the box
  world.step(6);
  const Lines lines = world.take();
  CHECK(lines_of(lines, "P") == lines_of(lines, "Q"));
  CHECK(lines_of(lines, "P").size() == 8);
  CHECK(lines_of(lines, "P")[1].find("enterTime 1004.45") != std::string::npos);
}

TEST_CASE("gives the events of calls in each step, for any movement of viewer, sensor and hierarchy") {
  World world("DEF M Transform { children [ DEF T Transform { children [ DEF P ProximitySensor { size 3 3 3 } " +
              wakeful("Q", "size 3 3 3") +
              " ] } DEF U Transform { translation 6 0 0 } ] } DEF Far ProximitySensor { size 1 1 1 } "
              "DEF V Viewpoint { position 9 0 0 } DEF W Viewpoint { position -9 0 0 }");
  world.start();
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-6, 6);
  const SceneGraph& scene = world.scene();
  const MFNode sensors = scene.get<MFNode>(world.node("T"), "children");
  int rests = 0;
  bool inside_u = false;
  SFVec3f center(0);
  for (int i = 1; i < 3000; ++i) {
    switch (random() % 40) {
      case 0:
        world.send("T.translation", SFVec3f(place(random), 0, 0));
        break;
      case 1:
        world.send("M.scale", SFVec3f(1 + static_cast<float>(random() % 2), 1, 1));
        break;
      case 2:
        for (const std::string name : {"P", "Q"}) world.send(name + ".size", SFVec3f(3, 2, 3));
        break;
      case 3:
        for (const std::string name : {"P", "Q"}) world.send(name + ".enabled", true);
        break;
      case 4:
        for (const std::string name : {"P", "Q"}) world.send(name + ".enabled", false);
        for (const std::string name : {"P", "Q"}) world.send(name + ".enabled", true);
        break;
      case 5:
        inside_u = !inside_u;
        world.send(inside_u ? "U.addChildren" : "U.removeChildren", sensors);
        break;
      case 6:
        world.execution().viewer().jump();
        break;
      case 7:
        world.send(random() % 2 == 0 ? "V.set_bind" : "W.set_bind", true);
        break;
      case 8:
        center = SFVec3f(place(random) / 6, 0, 0);
        for (const std::string name : {"P", "Q"}) world.send(name + ".center", center);
        break;
      default:
        break;
    }
    if (random() % 8 == 0) world.execution().viewer().set(viewer_place(place(random) * 2, place(random) / 4, 0));
    world.step(i / 8.0);
    rests += static_cast<int>(world.execution().viewer().idle().count() > 1);
  }
  const Lines lines = world.take();
  CHECK(lines_of(lines, "P") == lines_of(lines, "Q"));
  CHECK(lines_of(lines, "P").size() > 200);
  CHECK(rests > 100);
}

TEST_CASE("keeps the order of events among sensors that have rested") {
  std::string text;
  for (int i = 0; i < 8; ++i) text += "DEF P" + std::to_string(i) + " ProximitySensor { size 2 2 2 } ";
  World world(text);
  world.start();
  world.execution().viewer().set(viewer_place(9, 0, 0));
  for (int i = 1; i < 4; ++i) world.step(i);
  CHECK(world.execution().viewer().idle().count() == 8);
  world.send("P5.size", SFVec3f(2, 2, 1));
  world.send("P1.size", SFVec3f(2, 2, 1));
  (void)world.take();
  world.execution().viewer().set(viewer_place(0, 0, 0));
  world.step(5);
  const Lines lines = world.take("isActive");
  REQUIRE(lines.size() == 8);
  for (int i = 0; i < 8; ++i) CHECK(lines[static_cast<std::size_t>(i)] == "5 P" + std::to_string(i) + ".isActive TRUE");
}

TEST_CASE("never lets sensors rest below a Billboard or a singular Transform") {
  World world(
      "Billboard { children DEF B ProximitySensor { size 2 2 2 center 9 0 0 } } Transform { scale 1 0 1 children DEF S "
      "ProximitySensor { size 2 2 2 } }");
  world.start();
  for (int i = 1; i < 5; ++i) world.step(i);
  CHECK(world.execution().viewer().idle().count() == 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  world.execution().viewer().set(viewer_place(nan, nan, nan));
  world.step(6);
}

TEST_CASE("rests rarely below a Transform that moves in each step") {
  World world("DEF T Transform { children DEF P ProximitySensor { size 2 2 2 } }");
  world.start();
  int rests = 0;
  for (int i = 1; i <= 200; ++i) {
    world.send("T.translation", SFVec3f(100 + static_cast<float>(i), 0, 0));
    world.step(i);
    rests += static_cast<int>(world.execution().viewer().idle().count());
  }
  CHECK(rests > 0);
  CHECK(rests < 12);
}

TEST_CASE("evaluates a hundred thousand resting sensors within two milliseconds a step", "[optimised]") {
  constexpr int kSensors = 100'000, kSteps = 100;
  std::string text;
  for (int i = 0; i < kSensors; ++i)
    text += "Transform { translation " + std::to_string(i % 317 * 20) + " 0 " + std::to_string(i / 317 * 20) +
            " children ProximitySensor { size 5 5 5 } }\n";
  World world(text);
  world.start();
  for (int i = 1; i < 3; ++i) world.step(i);
  CHECK(world.execution().viewer().idle().count() == kSensors);
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kSteps; ++i) {
    world.execution().viewer().set(viewer_place(i, 0, 0));
    world.step(3 + i / 60.0);
  }
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - begin;
  INFO(taken.count() / kSteps << " ms a step");
  CHECK(taken.count() / kSteps < 2);
  CHECK_FALSE(world.take().empty());
}

}  // namespace gs::vrml::traces
