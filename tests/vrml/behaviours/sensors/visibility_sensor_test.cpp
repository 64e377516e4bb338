#include "tests/vrml/events/trace.h"

#include <glm/gtc/matrix_transform.hpp>

#include <limits>

namespace gs::vrml::traces {
namespace {

glm::dmat4 looking_at_x(double x) { return glm::translate(glm::dmat4(1), {x, 0, 10}); }

}  // namespace

TEST_CASE("reports when the box of a VisibilitySensor enters and leaves the view (6.54)") {
  World world(
      "Transform { translation 100 0 0 scale 2 2 2 children DEF V VisibilitySensor { size 1 1 1 } } "
      "DEF W VisibilitySensor { size 1 1 1 }");
  world.start();
  CHECK(world.take() == Lines{"0 W.isActive TRUE", "0 W.enterTime 1000"});  // seen from 0 0 10
  world.execution().viewer().set(looking_at_x(100));
  CHECK(world.take_at(1) ==
        Lines{"1 V.isActive TRUE", "1 V.enterTime 1001", "1 W.isActive FALSE", "1 W.exitTime 1001"});
  CHECK(world.take_at(2).empty());
  world.send("V.enabled", false);
  CHECK(world.take() == Lines{"2 V.enabled FALSE", "2 V.isActive FALSE", "2 V.exitTime 1002"});
  CHECK(world.take_at(3).empty());
  world.send_at(4, "V.enabled", true);
  CHECK(world.take("isActive") == Lines{"4 V.isActive TRUE"});
  // The viewer looks from behind.
  world.execution().viewer().set(glm::rotate(looking_at_x(100), 3.14159, {0.0, 1.0, 0.0}));
  CHECK(world.take_at(5, "isActive") == Lines{"5 V.isActive FALSE"});
}

TEST_CASE("derives the edges of the view from fieldOfView, aspect ratio and the renderer (6.53, 6.54)") {
  // tan(0.785398 / 2) = 0.414. At a distance of 10 the view extends 4.14 up and 5.52 to the side.
  World world(
      "DEF A Viewpoint { position 0 0 10 } DEF B Viewpoint { position 0 0 10 fieldOfView 1.5707963 } "
      "DEF In VisibilitySensor { center 5.4 0 0 } DEF Out VisibilitySensor { center 0 5.4 0 }");
  world.start();
  CHECK(world.take("isActive") == Lines{"0 In.isActive TRUE"});
  world.send_at(1, "B.set_bind", true);
  CHECK(world.take_at(2, "isActive") == Lines{"1 Out.isActive TRUE"});
  world.execution().viewer().set_aspect(0.5);  // 10 to the side, 20 up
  CHECK(world.take_at(3, "isActive").empty());
  world.execution().viewer().set(looking_at_x(0), Frustum{0.5, 1});
  CHECK(world.take_at(4, "isActive") == Lines{"4 In.isActive FALSE"});
  world.execution().viewer().set_aspect(std::numeric_limits<double>::quiet_NaN());
  world.execution().viewer().set(looking_at_x(0));
  CHECK(world.take_at(5, "isActive") == Lines{"5 In.isActive TRUE"});
}

TEST_CASE("uses the union of the boxes of a VisibilitySensor with several instances (6.54)") {
  World world(
      "Transform { translation 100 0 0 children DEF V VisibilitySensor { size 1 1 1 } } "
      "Transform { translation -100 0 0 children USE V } DEF N VisibilitySensor { center 0 0 50 }");
  world.start();
  CHECK(world.take().empty());
  world.execution().viewer().set(looking_at_x(-100));
  CHECK(world.take_at(1, "isActive") == Lines{"1 V.isActive TRUE"});
  world.execution().viewer().set(looking_at_x(100));
  CHECK(world.take_at(2).empty());
  // A box around the viewer, boxes with invalid sizes, and a box behind a viewer at infinity.
  world.send("N.size", SFVec3f(100, 100, 100));
  world.send("V.size", SFVec3f(-1, 1, 1));
  world.execution().viewer().set(looking_at_x(0));
  CHECK(world.take_at(3, "isActive") == Lines{"2 V.isActive FALSE", "3 N.isActive TRUE"});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  world.send("N.size", SFVec3f(nan, 1, std::numeric_limits<float>::infinity()));
  CHECK(world.take_at(4, "isActive") == Lines{"4 N.isActive FALSE"});
  world.send("V.size", SFVec3f(1, 1, 1));
  world.execution().viewer().set(glm::dmat4(0.0));
  world.step(5);
  (void)world.take();
}

}  // namespace gs::vrml::traces
