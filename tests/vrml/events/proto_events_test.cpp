#include "tests/vrml/events/trace.h"

#include <algorithm>
#include <string>

namespace gs::vrml::traces {

TEST_CASE("sends an event of an instance to every eventIn that IS it in that instance only (4.8.2)") {
  World world(R"(
PROTO P [ eventIn SFVec3f in ] { DEF A Transform { set_translation IS in children DEF B Transform { set_scale IS in } }
  DEF C Transform { set_center IS in } }
DEF One P { } DEF Two P { })");
  world.start();
  world.send("Two.in", SFVec3f(1, 2, 3));
  CHECK(world.take() == Lines{"0 A.translation 1 2 3", "0 B.scale 1 2 3", "0 C.center 1 2 3"});
  CHECK(world.scene().get<SFVec3f>(world.scene().resolve(world.node("One")), "translation") == SFVec3f(0));
  CHECK(world.scene().get<SFVec3f>(world.scene().resolve(world.node("Two")), "translation") == SFVec3f(1, 2, 3));
}

TEST_CASE("connects all IS pairs that Table 4.4 allows") {
  World world(R"(
PROTO P [ exposedField SFVec3f both 1 1 1  field SFVec3f start 7 7 7  eventIn SFVec3f in  eventOut SFVec3f out
          field SFVec3f size 3 3 3  eventIn SFFloat part  eventOut SFFloat value ] {
  DEF EE Transform { translation IS both }
  DEF FE Transform { scale IS start  bboxSize IS size }
  DEF IE Transform { center IS in }
  DEF OE Transform { }
  DEF OO Transform { translation_changed IS out }
  DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 4 ] set_fraction IS part value_changed IS value }
  ROUTE IE.center TO OO.translation }
DEF Q P { } DEF T Transform { } DEF M Material { } ROUTE Q.both TO T.translation ROUTE Q.out TO T.scale
ROUTE Q.value TO M.shininess)");
  world.start();
  CHECK(world.scene().get<SFVec3f>(world.node("EE"), "translation") == SFVec3f(1));
  CHECK(world.scene().get<SFVec3f>(world.node("FE"), "scale") == SFVec3f(7));
  CHECK(world.scene().get<SFVec3f>(world.node("FE"), "bboxSize") == SFVec3f(3));
  world.send("Q.both", SFVec3f(2));
  CHECK(world.take() == Lines{"0 EE.translation 2 2 2", "0 Q.both 2 2 2", "0 T.translation 2 2 2"});
  world.send("Q.in", SFVec3f(5));
  CHECK(world.take() == Lines{"0 IE.center 5 5 5", "0 OO.translation 5 5 5", "0 Q.out 5 5 5", "0 T.scale 5 5 5"});
  world.send("Q.part", SFFloat{0.5F});
  CHECK(world.take() == Lines{"0 I.value_changed 2", "0 Q.value 2", "0 M.shininess 2"});
}

TEST_CASE("updates an exposedField of the interface when the inner node changes itself (4.8.2)") {
  World world(R"(
PROTO P [ exposedField SFVec3f at 0 0 0 eventIn SFVec3f push ] {
  DEF In Transform { translation IS at } DEF Pusher Transform { set_scale IS push }
  ROUTE Pusher.scale TO In.translation }
DEF I P { } DEF T Transform { } ROUTE I.at_changed TO T.translation)");
  world.start();
  world.send("I.push", SFVec3f(1, 2, 3));
  CHECK(world.take() ==
        Lines{"0 Pusher.scale 1 2 3", "0 In.translation 1 2 3", "0 I.at 1 2 3", "0 T.translation 1 2 3"});
  CHECK(world.scene().get<SFVec3f>(world.node("I"), "at") == SFVec3f(1, 2, 3));
}

TEST_CASE("keeps the latest of several eventOuts that share one eventOut of the interface (4.8.2)") {
  World world(R"(
PROTO P [ eventIn SFVec3f a eventIn SFVec3f b eventOut SFVec3f out ] {
  DEF A Transform { set_translation IS a translation_changed IS out }
  DEF B Transform { set_translation IS b translation_changed IS out } }
DEF I P { } DEF T Transform { } ROUTE I.out TO T.translation)");
  world.start();
  world.send("I.a", SFVec3f(1));
  world.send_at(1, "I.b", SFVec3f(2));
  CHECK(world.take("T.") == Lines{"0 T.translation 1 1 1", "1 T.translation 2 2 2"});
  world.send_at(2, "I.a", SFVec3f(3));
  world.send("I.b", SFVec3f(4));  // with the same timestamp: one event of the eventIn
  CHECK(world.take("T.") == Lines{"2 T.translation 3 3 3"});
}

TEST_CASE("runs time-dependent nodes inside PROTO instances (4.8)") {
  World world(R"(
PROTO Clock [ exposedField SFTime length 4 exposedField SFBool loop FALSE eventIn SFTime go eventOut SFFloat part ] {
  Group { children DEF T TimeSensor { cycleInterval IS length loop IS loop set_startTime IS go fraction_changed IS part } } }
DEF A Clock { loop TRUE } DEF B Clock { length 2 } DEF M Material { } DEF N Material { }
ROUTE A.part TO M.transparency ROUTE B.part TO N.transparency)");
  world.start();
  world.step(1);
  (void)world.take();
  world.send("B.go", SFTime{1001});
  world.step(2);
  const Lines lines = world.take(".transparency");
  CHECK(lines == Lines{"1 N.transparency 0", "2 M.transparency 0.5", "2 N.transparency 0.5"});
}

TEST_CASE("runs nodes after the first one of a PROTO's body (4.8.2)") {
  World world(R"(
PROTO Spin [ ] { DEF Place Transform { } DEF T TimeSensor { loop TRUE cycleInterval 4 }
  DEF I PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 4 0 0 ] }
  ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO Place.translation }
Spin { } Spin { })");
  world.start();
  (void)world.take();
  CHECK(world.take_at(1, "translation") == Lines{"1 Place.translation 1 0 0", "1 Place.translation 1 0 0"});
}

TEST_CASE("ignores events for an EXTERNPROTO without a body, and connects its ROUTEs later (4.9.1)") {
  World world(
      "EXTERNPROTO E [ eventIn SFVec3f in eventOut SFVec3f out ] \"nowhere.wrl\" DEF I E { } DEF A Transform { } "
      "DEF B Transform { } ROUTE A.translation TO I.in ROUTE I.out TO B.translation");
  world.start();
  world.send("A.translation", SFVec3f(1));
  world.send("I.in", SFVec3f(2));
  CHECK(world.take() == Lines{"0 A.translation 1 1 1"});
}

TEST_CASE("keeps the initial value of an exposedField of an EXTERNPROTO without a body, and sends nothing (4.9.1)") {
  World world(
      "EXTERNPROTO E [ exposedField SFVec3f place ] \"nowhere.wrl\" DEF I E { place 1 2 3 } DEF A Transform { } "
      "DEF B Transform { } ROUTE A.translation TO I.place ROUTE I.place TO B.translation");
  world.start();
  world.send("A.translation", SFVec3f(4));
  CHECK(world.take() == Lines{"0 A.translation 4 4 4"});
  CHECK(world.scene().get<SFVec3f>(world.node("I"), "place") == SFVec3f(1, 2, 3));
}

}  // namespace gs::vrml::traces
