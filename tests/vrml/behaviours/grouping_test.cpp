#include "tests/vrml/events/trace.h"

#include <algorithm>
#include <string>

namespace gs::vrml::traces {

TEST_CASE(
    "appends new children on addChildren and removes present ones on removeChildren, in all grouping nodes (4.6.5)") {
  for (const char* type : {"Anchor", "Billboard", "Collision", "Group", "Transform"}) {
    INFO(type);
    World world("DEF A Group { } DEF Z Group { } DEF G " + std::string(type) +
                " { children [ DEF Q Group { } DEF L Group { } DEF S Group { } ] }");
    const NodeId a = world.node("A"), l = world.node("L"), z = world.node("Z");
    world.start();
    (void)world.take();
    world.send_at(1, "G.addChildren", MFNode{a, l, z});
    CHECK(world.take() == Lines{"1 G.children [ Q, L, S, A, Z ]"});
    world.send_at(2, "G.removeChildren", MFNode{a, l, z});
    CHECK(world.take() == Lines{"2 G.children [ Q, S ]"});
    world.send_at(3, "G.children", MFNode{z});
    CHECK(world.take() == Lines{"3 G.children [ Z ]"});
    CHECK(world.scene().get<MFNode>(world.node("G"), "children") == MFNode{z});
  }
}

TEST_CASE("keeps the capacity below twice the number of children that are added one by one (4.6.5)") {
  std::string nodes = "DEF G Group { }";
  for (int i = 0; i < 60; ++i) nodes += " DEF N" + std::to_string(i) + " Group { }";
  World world(nodes);
  world.start();
  for (int i = 0; i < 60; ++i) {
    world.send_at(1 + i, "G.addChildren", MFNode{world.node("N" + std::to_string(i))});
  }
  const MFNode& children = world.scene().get<MFNode>(world.node("G"), "children");
  CHECK(children.size() == 60);
  CHECK(children.capacity() <= 128);
}

TEST_CASE("sends no event if addChildren or removeChildren changes nothing (4.6.5)") {
  World world("DEF G Group { children [ DEF A Group { } ] } DEF B Group { }");
  world.start();
  world.send("G.addChildren", MFNode{});
  world.send("G.addChildren", MFNode{world.node("A")});
  world.send("G.removeChildren", MFNode{world.node("B")});
  world.send("G.removeChildren", MFNode{});
  CHECK(world.take().empty());
}

TEST_CASE("passes addChildren and removeChildren through ROUTEs and PROTO interfaces (4.6.5, 4.8.2)") {
  World world(R"(
PROTO Box2 [ eventIn MFNode add eventIn MFNode remove eventOut MFNode children_changed ] {
  DEF Inner Group { addChildren IS add removeChildren IS remove children_changed IS children_changed } }
DEF I Box2 { } DEF From Group { } DEF Gone Group { } DEF A Group { } DEF Watch Group { }
ROUTE From.children TO I.add ROUTE Gone.children TO I.remove ROUTE I.children_changed TO Watch.children)");
  world.start();
  world.send("From.children", MFNode{world.node("A")});
  CHECK(world.take("Watch.") == Lines{"0 Watch.children [ A ]"});
  world.send_at(1, "Gone.children", MFNode{world.node("A")});
  CHECK(world.take("Watch.") == Lines{"1 Watch.children [ ]"});
}

TEST_CASE("keeps one state and sends one event for a node with several parents (4.6.2)") {
  World world(R"(
Group { children DEF T TimeSensor { cycleInterval 4 loop TRUE } }
Transform { children [ USE T DEF M Transform { } ] } Transform { translation 5 0 0 children [ USE M USE T ] }
DEF I PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 4 0 0 ] } USE I
ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO M.translation)");
  world.start();
  (void)world.take();
  CHECK(world.take_at(1) ==
        Lines{"1 T.fraction_changed 0.25", "1 T.time 1001", "1 I.value_changed 1 0 0", "1 M.translation 1 0 0"});
}

TEST_CASE("sends and receives events of nodes below a Switch or LOD, whichever child is chosen (6.26, 6.46)") {
  World world(R"(
DEF S Switch { whichChoice -1 choice [ Group { children [ DEF T TimeSensor { loop TRUE cycleInterval 4 }
  DEF I PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 4 0 0 ] } ] } ] }
DEF L LOD { range [ 1, 2 ] level [ Group { } Group { } Group { children [ DEF Near Transform { }
  DEF U TimeSensor { loop TRUE cycleInterval 8 } ] } ] }
ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO Near.translation)");
  world.start();
  (void)world.take();
  CHECK(world.take_at(1, "T.fraction") == Lines{"1 T.fraction_changed 0.25"});
  CHECK(world.take_at(2, "Near.") == Lines{"2 Near.translation 2 0 0"});
  world.send("S.whichChoice", SFInt32{0});
  world.send_at(3, "S.whichChoice", SFInt32{7});  // no such child: chooses none
  world.step(3.5);
  const Lines lines = world.take();
  CHECK(std::count(lines.begin(), lines.end(), "3 U.fraction_changed 0.375") == 1);
  CHECK(std::count(lines.begin(), lines.end(), "3.5 Near.translation 3.5 0 0") == 1);
}

TEST_CASE("accepts children and choices of Switch, LOD and Billboard as events (6.6, 6.26, 6.46)") {
  World world(
      "DEF A Group { } DEF B Group { } DEF S Switch { choice USE A } DEF L LOD { level USE A } DEF D Billboard { } "
      "DEF S2 Switch { } DEF L2 LOD { } DEF D2 Billboard { } ROUTE S.choice TO S2.choice ROUTE L.level TO L2.level "
      "ROUTE S.whichChoice TO S2.whichChoice ROUTE D.axisOfRotation TO D2.axisOfRotation");
  world.start();
  const MFNode both{world.node("A"), world.node("B")};
  world.send("S.choice", both);
  world.send("S.whichChoice", SFInt32{1});
  world.send("L.level", both);
  world.send("D.axisOfRotation", SFVec3f(0));
  CHECK(world.take("2.") ==
        Lines{"0 S2.choice [ A, B ]", "0 S2.whichChoice 1", "0 L2.level [ A, B ]", "0 D2.axisOfRotation 0 0 0"});
  CHECK(world.scene().get<MFNode>(world.node("S2"), "choice") == both);
  CHECK(world.scene().get<MFNode>(world.node("L2"), "level") == both);
}

TEST_CASE("runs interpolators and time sensors anywhere in the file, also outside the scene hierarchy (4.4.4, 4.6.8)") {
  World world(R"(
DEF Out Group { children DEF T TimeSensor { loop TRUE cycleInterval 4 } }
DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 8 ] } ROUTE T.fraction_changed TO I.set_fraction)");
  world.start();
  world.step(1);
  (void)world.take();
  world.send("Out.removeChildren", MFNode{world.node("T")});
  (void)world.take();
  CHECK(world.take_at(2) == Lines{"2 T.fraction_changed 0.5", "2 T.time 1002", "2 I.value_changed 4"});
}

}  // namespace gs::vrml::traces
