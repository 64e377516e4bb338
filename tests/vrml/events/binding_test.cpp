#include "tests/vrml/events/trace.h"

#include <string>

namespace gs::vrml::traces {
namespace {

NodeId bound_node(World& world, const char* type) {
  return world.execution().stacks().bound(*built_in_node_type(type)).node;
}

}  // namespace

TEST_CASE("binds at start only the first node of a PROTO instance, not later ones (4.6.10)") {
  World world(R"(
PROTO First [ ] { DEF V Viewpoint { } DEF F Fog { } }
PROTO Second [ ] { Group { children DEF G Fog { } } DEF N NavigationInfo { } }
First { } Viewpoint { } Second { } Fog { })");
  world.start();
  CHECK(world.take("isBound") == Lines{"0 V.isBound TRUE", "0 G.isBound TRUE"});
  CHECK(!bound_node(world, "NavigationInfo"));
}

TEST_CASE("binds nothing and sends nothing in a file without bindable nodes (4.6.10)") {
  World world("Group { } PROTO P [ ] { Viewpoint { } }");
  world.start();
  CHECK(world.take().empty());
  CHECK(!bound_node(world, "Viewpoint"));
}

TEST_CASE("sends isBound FALSE before TRUE with one timestamp, on all four stacks (4.6.10)") {
  for (const char* type : {"Background", "Fog", "NavigationInfo", "Viewpoint"}) {
    INFO(type);
    World world("DEF A " + std::string(type) + " { } DEF B " + type + " { }");
    world.start();
    CHECK(world.take("isBound") == Lines{"0 A.isBound TRUE"});
    world.send_at(1, "B.set_bind", true);
    CHECK(world.take("isBound") == Lines{"1 A.isBound FALSE", "1 B.isBound TRUE"});
    world.send_at(2, "B.set_bind", false);
    CHECK(world.take("isBound") == Lines{"2 B.isBound FALSE", "2 A.isBound TRUE"});
  }
}

TEST_CASE("sends bindTime when a Viewpoint is bound and unbound (6.53)") {
  World world("DEF A Viewpoint { } DEF B Viewpoint { }");
  world.start();
  CHECK(world.take("bindTime") == Lines{"0 A.bindTime 1000"});
  world.send_at(1, "B.set_bind", true);
  CHECK(world.take("bindTime") == Lines{"1 A.bindTime 1001", "1 B.bindTime 1001"});
  world.send_at(2, "A.set_bind", false);  // below the top
  CHECK(world.take().empty());
}

TEST_CASE("keeps the last of several nodes that are bound at one time, and sends each isBound (4.6.10)") {
  World world(R"(
DEF V Viewpoint { } DEF A Viewpoint { } DEF B Viewpoint { } DEF C Viewpoint { } DEF L DirectionalLight { on FALSE }
DEF LA DirectionalLight { } ROUTE L.on TO A.set_bind ROUTE L.on TO B.set_bind ROUTE L.on TO C.set_bind
ROUTE A.isBound TO LA.on)");
  world.start();
  (void)world.take();
  world.send_at(1, "L.on", true);
  CHECK(bound_node(world, "Viewpoint") == world.node("C"));
  CHECK(world.take("C.isBound") == Lines{"1 C.isBound TRUE"});
  // A was bound and unbound with one timestamp. Its eventOut sends once per timestamp, so the rest follows with the
  // next.
  CHECK(world.take_at(2, "isBound") == Lines{"2 A.isBound FALSE", "2 B.isBound FALSE"});
  CHECK(!world.scene().get<SFBool>(world.node("LA"), "on"));
  CHECK(world.take_at(3).empty());
}

TEST_CASE("unbinds a bound node that is removed from the world (4.6.10)") {
  for (const char* type : {"Background", "Fog", "NavigationInfo", "Viewpoint"}) {
    INFO(type);
    World world("DEF A " + std::string(type) + " { } DEF G Transform { children DEF B " + type +
                " { } } DEF H Group { children [ USE G ] }");
    world.start();
    world.send_at(1, "B.set_bind", true);
    (void)world.take();
    world.send_at(2, "G.removeChildren", MFNode{world.node("B")});
    CHECK(world.take("isBound") == Lines{"2 B.isBound FALSE", "2 A.isBound TRUE"});
    CHECK(bound_node(world, type) == world.node("A"));
    world.step(3);  // removed from the stack
    world.send("A.set_bind", false);
    CHECK(world.take("isBound") == Lines{"3 A.isBound FALSE"});
  }
}

TEST_CASE("unbinds a bound node with the group, choice, level or list that contained it (4.6.10)") {
  World world(R"(
DEF V Viewpoint { } DEF S Switch { whichChoice 0 choice Group { children DEF A Viewpoint { } } }
DEF L LOD { level Transform { children DEF B Viewpoint { } } } DEF G Group { children DEF C Viewpoint { } })");
  world.start();
  for (const char* name : {"A", "B", "C"}) {
    world.send_at(world.execution().now() - World::kStart + 1, std::string(name) + ".set_bind", true);
  }
  (void)world.take();
  world.send_at(4, "G.children", MFNode{});
  CHECK(world.take("isBound") == Lines{"4 C.isBound FALSE", "4 B.isBound TRUE"});
  world.send_at(5, "S.choice", MFNode{});  // below the top: sends no event
  CHECK(world.take("isBound").empty());
  world.send_at(6, "L.level", MFNode{});
  CHECK(world.take("isBound") == Lines{"6 B.isBound FALSE", "6 V.isBound TRUE"});
}

TEST_CASE("keeps a bound node while one USE of it remains, and while it moves at one time (4.6.10)") {
  World world(R"(
DEF V Viewpoint { } DEF G Group { children DEF B Viewpoint { } } DEF H Group { children USE B } DEF K Group { }
DEF Old Group { } DEF New Group { } DEF Both Group { }
ROUTE Both.children TO H.removeChildren ROUTE Both.children TO K.addChildren)");
  world.start();
  world.send_at(1, "B.set_bind", true);
  world.send_at(2, "G.removeChildren", MFNode{world.node("B")});
  world.step(3);
  (void)world.take();
  world.send("Both.children", MFNode{world.node("B")});
  CHECK(world.take("isBound").empty());
  CHECK(bound_node(world, "Viewpoint") == world.node("B"));
}

TEST_CASE("keeps a bound node that was never in the world (4.6.10)") {
  World world(R"(
PROTO P [ eventIn SFBool bind ] { Group { } DEF Out Viewpoint { set_bind IS bind } }
DEF V Viewpoint { } DEF I P { } DEF G Group { children DEF X Group { } })");
  world.start();
  world.send_at(1, "I.bind", true);
  (void)world.take();
  world.send_at(2, "G.removeChildren", MFNode{world.node("X")});
  CHECK(world.take("isBound").empty());
  CHECK(bound_node(world, "Viewpoint") != world.node("V"));
}

TEST_CASE("sends no bindable events for groups without bindable nodes (4.6.10)") {
  World world("DEF V Viewpoint { } DEF G Group { children DEF A Group { } }");
  world.start();
  world.step(1);
  (void)world.take();
  world.send("G.removeChildren", MFNode{world.node("A")});
  world.send_at(2, "G.addChildren", MFNode{world.node("A")});
  CHECK(world.take("isBound").empty());
}

TEST_CASE("sends events of ProximitySensors that a bind leaves and enters with its timestamp (6.53)") {
  World world(R"(
DEF A Viewpoint { position 0 0 0 } DEF B Viewpoint { position 50 0 0 } DEF Here ProximitySensor { size 4 4 4 }
DEF There ProximitySensor { center 50 0 0 size 4 4 4 } DEF T TimeSensor { loop TRUE cycleInterval 8 })");
  world.start();
  CHECK(world.take("Here.isActive") == Lines{"0 Here.isActive TRUE"});
  world.step(1);
  (void)world.take();
  world.send("B.set_bind", true);
  CHECK(world.take() == Lines{"1 A.isBound FALSE", "1 A.bindTime 1001", "1 B.isBound TRUE", "1 B.bindTime 1001",
                              "1 Here.isActive FALSE", "1 Here.exitTime 1001", "1 Here.position_changed 50 0 0",
                              "1 Here.orientation_changed 0 0 1 0", "1 There.isActive TRUE", "1 There.enterTime 1001",
                              "1 There.position_changed 50 0 0", "1 There.orientation_changed 0 0 1 0"});
  CHECK(world.take_at(2) == Lines{"2 T.fraction_changed 0.25", "2 T.time 1002"});
}

}  // namespace gs::vrml::traces
