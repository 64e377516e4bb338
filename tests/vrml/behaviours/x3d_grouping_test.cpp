#include "tests/vrml/events/trace.h"

#include "vrml/behaviours/browser_events.h"
#include "vrml/scene/values/transformation.h"

#include <vector>

// Tests of the events that X3D adds to grouping nodes.
namespace gs::vrml::traces {

TEST_CASE("adds and removes children of a Switch and a LOD (X3D 10.3.2)") {
  X3DWorld world("DEF S Switch { choice [ DEF A Group { } ] } DEF L LOD { } DEF B Group { }");
  world.start();
  world.send_at(1, "S.addChildren", MFNode{world.node("B"), world.node("A")});
  CHECK(world.take() == Lines{"1 S.choice [ A, B ]"});
  world.send_at(2, "S.removeChildren", MFNode{world.node("A")});
  CHECK(world.take() == Lines{"2 S.choice [ B ]"});
  world.send_at(3, "L.addChildren", MFNode{world.node("B")});
  CHECK(world.take() == Lines{"3 L.level [ B ]"});
}

TEST_CASE("accepts the names of X3D for fields that VRML97 names differently (X3D 10.4.4, 23.3.3)") {
  X3DWorld world("DEF S Switch { children [ DEF A Group { } ] } DEF L LOD { children [ USE A ] }");
  world.start();
  world.send_at(1, "S.set_children", MFNode{world.node("A"), world.node("A")});
  CHECK(world.take() == Lines{"1 S.choice [ A, A ]"});
}

TEST_CASE("sends level_changed of a LOD while another node listens (X3D 23.4.3)") {
  X3DWorld world(R"(
DEF L LOD { center 0 0 0 range [ 5 20 ] level [ Group { } Group { } Group { } ] }
DEF I IntegerTrigger { }
ROUTE L.level_changed TO I.integerKey)");
  world.execution().viewer().set(viewer_matrix({0, 0, 10}, {}));
  world.start();
  CHECK(world.take("level_changed") == Lines{"0 L.level_changed 1"});
  CHECK(world.take_at(1).empty());
  world.execution().viewer().set(viewer_matrix({0, 0, 30}, {}));
  CHECK(world.take_at(2) == Lines{"2 L.level_changed 2", "2 I.integerKey 2"});
  world.execution().viewer().set(viewer_matrix({0, 0, 1}, {}));
  CHECK(world.take_at(3, "level_changed") == Lines{"3 L.level_changed 0"});
}

TEST_CASE("sends isActive of a Collision from the first collision to the first step without one (X3D 23.4.2)") {
  X3DWorld world("DEF C Collision { enabled TRUE children [ DEF G Group { } ] }");
  world.start();
  const std::vector<PathStep> path{{&world.scene(), world.node("C")}, {&world.scene(), world.node("G")}};
  const auto hit = [&](double at) {
    world.step(at);
    CHECK(collide(world.execution(), path));
  };
  hit(1);
  CHECK(world.take() == Lines{"1 C.collideTime 1001", "1 C.isActive TRUE"});
  hit(2);
  CHECK(world.take() == Lines{"2 C.collideTime 1002"});
  CHECK(world.take_at(3).empty());
  CHECK(world.take_at(4) == Lines{"4 C.isActive FALSE"});
  CHECK_FALSE(world.execution().next_time());
}

}  // namespace gs::vrml::traces
