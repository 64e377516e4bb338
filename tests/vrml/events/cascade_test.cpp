#include "tests/vrml/events/trace.h"

#include <algorithm>
#include <string>

namespace gs::vrml::traces {
namespace {

std::ptrdiff_t times_in(const Lines& lines, const char* line) { return std::count(lines.begin(), lines.end(), line); }

}  // namespace

TEST_CASE("gives all events of a cascade the timestamp of the first one (4.10.3)") {
  World world(R"(
DEF T TimeSensor { cycleInterval 4 loop TRUE } DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] }
DEF J PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] } DEF A Transform { } DEF B Transform { }
ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO J.set_fraction
ROUTE J.value_changed TO A.translation ROUTE A.translation TO B.scale)");
  world.start();
  (void)world.take();
  CHECK(world.take_at(1) == Lines{"1 T.fraction_changed 0.25", "1 T.time 1001", "1 I.value_changed 0.25",
                                  "1 J.value_changed 0.25 0.25 0.25", "1 A.translation 0.25 0.25 0.25",
                                  "1 B.scale 0.25 0.25 0.25"});
}

TEST_CASE("runs a cascade for each of several sensor events of one timestamp (4.10.3)") {
  World world(R"(
DEF T TimeSensor { startTime 1001 cycleInterval 4 }
DEF L DirectionalLight { on FALSE } DEF U TimeSensor { enabled FALSE } DEF I ScalarInterpolator { key 0 keyValue 5 }
ROUTE T.isActive TO L.on ROUTE T.cycleTime TO U.stopTime ROUTE T.time TO U.startTime
ROUTE T.fraction_changed TO I.set_fraction)");
  world.start();
  (void)world.take();
  world.step(1);
  const Lines lines = world.take();
  CHECK(times_in(lines, "1 L.on TRUE") == 1);
  CHECK(times_in(lines, "1 U.stopTime 1001") == 1);
  CHECK(times_in(lines, "1 U.startTime 1001") == 1);
  CHECK(times_in(lines, "1 I.value_changed 5") == 1);
}

TEST_CASE("ends a loop through several nodes and a PROTO instance after one round per timestamp (4.10.4)") {
  World world(R"(
PROTO Pass [ eventIn SFVec3f in eventOut SFVec3f out ] {
  DEF Core Transform { set_translation IS in translation_changed IS out } }
DEF A Transform { } DEF P Pass { } DEF B Transform { }
ROUTE A.translation TO P.in ROUTE P.out TO B.translation ROUTE B.translation TO A.translation)");
  world.start();
  for (int round = 1; round < 4; ++round) {
    world.step(round);
    (void)world.take();
    world.send("B.translation", SFVec3f(static_cast<float>(round)));
    CHECK(world.take().size() == 4);  // B, A, Core, P
  }
}

TEST_CASE("stops cyclic dependencies between sensors within a timestamp, and resumes at the next (4.10.4)") {
  World world(R"(
DEF A TimeSensor { cycleInterval 100 } DEF B TimeSensor { cycleInterval 100 }
ROUTE A.isActive TO B.loop ROUTE B.isActive TO A.loop ROUTE A.time TO B.startTime ROUTE B.time TO A.startTime)");
  world.start();
  world.send("A.startTime", SFTime{1000});
  for (int i = 1; i < 5; ++i) {
    (void)world.take();
    world.step(i);
    const Lines lines = world.take("A.time");
    CHECK(lines.size() == 1);
  }
}

TEST_CASE("delivers events of one timestamp in the order of sending, equally in every run (4.10.3)") {
  const auto trace = [] {
    std::string text = "DEF S Switch { }";
    for (int i = 0; i < 20; ++i) text += " DEF N" + std::to_string(i) + " Switch { }";
    for (int i = 0; i < 20; ++i)
      text += " ROUTE S.whichChoice TO N" + std::to_string((i * 7) % 20) + ".whichChoice ROUTE N" + std::to_string(i) +
              ".whichChoice TO N" + std::to_string((i * 3) % 20) + ".whichChoice";
    World world(text);
    world.start();
    world.send("S.whichChoice", SFInt32{1});
    return world.take();
  };
  const Lines first = trace();
  CHECK(first.size() == 21);
  CHECK(first == trace());
}

TEST_CASE("sends fan-out to every eventIn, and keeps the last value of a fan-in (4.10.5)") {
  World world(R"(
DEF A Transform { } DEF B Transform { } DEF C Transform { } DEF D Material { } DEF E Material { }
DEF L DirectionalLight { } DEF M DirectionalLight { } DEF N DirectionalLight { }
ROUTE L.on TO M.on ROUTE L.on TO N.on ROUTE L.intensity TO D.transparency ROUTE M.intensity TO D.transparency)");
  world.start();
  world.send("L.on", false);
  CHECK(world.take() == Lines{"0 L.on FALSE", "0 M.on FALSE", "0 N.on FALSE"});
  world.send_at(1, "L.intensity", SFFloat{0.25F});
  world.send_at(2, "M.intensity", SFFloat{0.75F});
  CHECK(world.take("D.") == Lines{"1 D.transparency 0.25", "2 D.transparency 0.75"});
  CHECK(world.scene().get<SFFloat>(world.node("D"), "transparency") == 0.75F);
}

TEST_CASE("applies an added or removed ROUTE from the next event on (4.10.2)") {
  World world("DEF A Switch { } DEF B Switch { } DEF C Switch { }");
  world.start();
  const auto route = [&](const char* to) {
    Route made{world.node("A"), world.node(to), nullptr, nullptr};
    made.event_out = made.event_in = world.scene().node(made.from).type->find("whichChoice");
    return made;
  };
  world.send("A.whichChoice", SFInt32{1});
  CHECK(world.execution().routes().add(world.scene(), route("B")));
  CHECK(world.take() == Lines{"0 A.whichChoice 1"});
  CHECK(world.scene().get<SFInt32>(world.node("B"), "whichChoice") == -1);
  world.send_at(1, "A.whichChoice", SFInt32{2});
  CHECK(world.take("B.") == Lines{"1 B.whichChoice 2"});
  CHECK(world.execution().routes().remove(world.scene(), route("B")));
  CHECK(world.execution().routes().add(world.scene(), route("C")));
  world.send_at(2, "A.whichChoice", SFInt32{3});
  CHECK(world.take() == Lines{"2 A.whichChoice 3", "2 C.whichChoice 3"});
}

TEST_CASE("updates continuous changes before an external event (4.11.3)") {
  World world(R"(
DEF T TimeSensor { startTime 1000 cycleInterval 8 loop TRUE } DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 8 ] }
DEF M Material { } ROUTE T.fraction_changed TO I.set_fraction ROUTE I.value_changed TO M.shininess)");
  world.start();
  world.step(1);
  (void)world.take();
  world.send_at(3, "M.transparency", SFFloat{1});
  CHECK(world.take() == Lines{"3 T.fraction_changed 0.375", "3 T.time 1003", "3 I.value_changed 3", "3 M.shininess 3",
                              "3 M.transparency 1"});
}

TEST_CASE("gives each time event a greater time than the one before (4.11.1)") {
  World world(
      "DEF T TimeSensor { startTime 1001 cycleInterval 0.75 loop TRUE stopTime 1004.3 } DEF U TimeSensor { } "
      "ROUTE T.time TO U.stopTime");
  world.start();
  double before = 0;
  for (int i = 1; i < 60; ++i) {
    world.step(i / 10.0);
    for (const std::string& line : world.take("T.time")) {
      const double time = std::stod(line.substr(line.rfind(' ')));
      CHECK(time > before);
      before = time;
    }
  }
  CHECK(before == 1004.3);
}

TEST_CASE("runs at times before 1970 (4.11.2)") {
  World world(
      "DEF T TimeSensor { startTime -1000 stopTime -2000 cycleInterval 4000 } DEF U TimeSensor { startTime -50 "
      "stopTime -100 }");
  world.start();
  CHECK(world.take("T.") ==
        Lines{"0 T.isActive TRUE", "0 T.cycleTime -1000", "0 T.fraction_changed 0.5", "0 T.time 1000"});
}

TEST_CASE("gives an Inline its own names and ROUTEs, in the time of the world (4.4, 6.25)") {
  World world("DEF Part Inline { } DEF Clock TimeSensor { loop TRUE cycleInterval 8 } DEF T Transform { }");
  auto content = std::make_unique<SceneGraph>("part.wrl", world.scene().budget());
  Diagnostics diagnostics;
  (void)parse(R"(#VRML V2.0 utf8
DEF Clock TimeSensor { loop TRUE cycleInterval 4 } DEF T Material { }
DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 4 ] }
ROUTE Clock.fraction_changed TO I.set_fraction ROUTE I.value_changed TO T.transparency)",
              *content, diagnostics);
  CHECK(diagnostics.errors() == 0);
  SceneGraph& part = *content;
  world.start();
  world.scene().inlines().attach(world.node("Part"), std::move(content));
  world.execution().scenes().attach();
  world.step(1);
  (void)world.take();
  world.step(2);
  const Lines lines = world.take();
  CHECK(times_in(lines, "2 I.value_changed 2") == 1);
  CHECK(times_in(lines, "2 T.transparency 2") == 1);
  CHECK(std::count_if(lines.begin(), lines.end(), [](const std::string& line) {
          return line.ends_with("Clock.fraction_changed 0.25") || line.ends_with("Clock.fraction_changed 0.5");
        }) == 2);
  CHECK(part.get<SFFloat>(part.roots()[1], "transparency") == 2);
  // No ROUTE leads from one scene to another.
  Route across{world.node("Clock"), part.roots()[2], nullptr, nullptr};
  across.event_out = world.scene().node(across.from).type->find("fraction_changed");
  across.event_in = part.node(across.to).type->find("set_fraction");
  CHECK(!world.execution().routes().add(part, across));
}

}  // namespace gs::vrml::traces
