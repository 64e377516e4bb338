#include "vrml/events/execution.h"

#include "tests/vrml/events/trace.h"
#include "vrml/scene/prototype.h"

#include <algorithm>
#include <string>

namespace gs::vrml::traces {

namespace {

const SFVec3f kFar(1, 2, 3);

Route route_of(World& world, const char* from, const char* event_out, const char* to, const char* event_in) {
  Route route{world.node(from), world.node(to), nullptr, nullptr};
  route.event_out = world.scene().node(route.from).type->find_event_out(event_out);
  route.event_in = world.scene().node(route.to).type->find_event_in(event_in);
  return route;
}

}  // namespace

TEST_CASE("accepts set_x and sends x_changed for an exposedField, under all its names (4.7)") {
  World world(
      "DEF A Transform { } DEF B Transform { } ROUTE A.translation TO B.translation "
      "ROUTE A.scale_changed TO B.set_scale");
  world.start();
  world.send("A.set_translation", kFar);
  world.send("A.scale", SFVec3f(2, 2, 2));
  CHECK(world.take() == Lines{"0 A.translation 1 2 3", "0 B.translation 1 2 3", "0 A.scale 2 2 2", "0 B.scale 2 2 2"});
  CHECK(world.scene().get<SFVec3f>(world.node("B"), "translation") == kFar);
}

TEST_CASE("sends one event per eventOut and timestamp, so that loops end (4.10.4)") {
  World world(
      "DEF A Transform { } DEF B Transform { } ROUTE A.translation TO B.translation "
      "ROUTE B.translation TO A.translation ROUTE A.translation TO A.translation");
  world.start();
  world.send("A.translation", kFar);
  CHECK(world.take() == Lines{"0 A.translation 1 2 3", "0 B.translation 1 2 3"});
  world.send("A.translation", SFVec3f(4, 5, 6));  // the same timestamp
  CHECK(world.take().empty());
  world.send_at(1, "B.translation", SFVec3f(7, 8, 9));
  CHECK(world.take() == Lines{"1 B.translation 7 8 9", "1 A.translation 7 8 9"});
}

TEST_CASE("sends fan-out in the order of the ROUTEs, and accepts every event of a fan-in (4.10.5)") {
  World world(
      "DEF A Transform { } DEF B Transform { } DEF C Transform { } DEF D Transform { }"
      "ROUTE A.translation TO C.translation ROUTE A.translation TO B.translation "
      "ROUTE C.translation TO D.translation ROUTE B.translation TO D.translation");
  world.start();
  world.send("A.translation", kFar);
  CHECK(world.take() ==
        Lines{"0 A.translation 1 2 3", "0 C.translation 1 2 3", "0 B.translation 1 2 3", "0 D.translation 1 2 3"});
}

TEST_CASE("counts a duplicate ROUTE once (4.10.2)") {
  World world(
      "DEF A Switch { } DEF B Switch { } ROUTE A.whichChoice TO B.whichChoice "
      "ROUTE A.whichChoice_changed TO B.set_whichChoice");
  world.start();
  const Route route = route_of(world, "A", "whichChoice", "B", "whichChoice");
  CHECK(!world.execution().routes().add(world.scene(), route));
  CHECK(world.execution().routes().remove(world.scene(), route));
  CHECK(!world.execution().routes().remove(world.scene(), route));
  world.send("A.whichChoice", SFInt32{4});
  CHECK(world.take() == Lines{"0 A.whichChoice 4"});
}

TEST_CASE("adds and removes ROUTEs while the world runs") {
  World world("DEF A Transform { } DEF B Transform { } DEF C Transform { }");
  world.start();
  const Route first = route_of(world, "A", "translation", "B", "translation");
  const Route second = route_of(world, "A", "translation", "C", "translation");
  for (int round = 1; round < 50; ++round) {
    world.step(round);
    CHECK(world.execution().routes().add(world.scene(), first));
    CHECK(world.execution().routes().add(world.scene(), second));
    world.send("A.translation", kFar);
    CHECK(world.take().size() == 3);
    CHECK(world.execution().routes().remove(world.scene(), first));
    world.send_at(round + 0.5, "A.translation", kFar);
    CHECK(world.take().size() == 2);
    CHECK(world.execution().routes().remove(world.scene(), second));
  }
}

TEST_CASE("rejects a ROUTE between unequal types or to an eventOut") {
  World world("DEF A Transform { } DEF B Transform { } DEF T TimeSensor { }");
  CHECK(!world.execution().routes().add(world.scene(), route_of(world, "A", "translation", "B", "rotation")));
  Route wrong = route_of(world, "T", "time", "T", "startTime");
  wrong.event_in = wrong.event_out;
  CHECK(!world.execution().routes().add(world.scene(), wrong));
}

TEST_CASE("passes events through the interface of a PROTO instance in both directions (4.8.2)") {
  World world(R"(
PROTO P [ eventIn SFVec3f move exposedField SFFloat shine 0.5 eventOut SFVec3f moved field SFInt32 fixed 1 ] {
  DEF Inner Transform { set_translation IS move translation_changed IS moved
    children Shape { appearance Appearance { material DEF Paint Material { shininess IS shine } } } } }
DEF I P { } DEF Copy Transform { } DEF M Material { }
ROUTE I.moved TO Copy.translation  ROUTE I.shine_changed TO M.set_shininess)");
  world.start();
  world.send("I.move", kFar);
  CHECK(world.take() == Lines{"0 Inner.translation 1 2 3", "0 I.moved 1 2 3", "0 Copy.translation 1 2 3"});
  world.send("I.set_shine", SFFloat{0.25F});
  CHECK(world.take() == Lines{"0 Paint.shininess 0.25", "0 I.shine 0.25", "0 M.shininess 0.25"});
  CHECK(world.scene().get<SFFloat>(world.node("I"), "shine") == 0.25F);
}

TEST_CASE("follows IS through nested instances to every node that names it") {
  World world(R"(
PROTO A [ exposedField SFVec3f at 0 0 0 ] { DEF One Transform { translation IS at } DEF Two Transform { scale IS at } }
PROTO B [ exposedField SFVec3f at 0 0 0 ] { DEF Nested A { at IS at } }
PROTO C [ exposedField SFVec3f at 0 0 0 eventIn SFVec3f to ] { B { at IS at } DEF Three Transform { set_center IS to } }
DEF I C { } DEF Source Transform { } DEF Sink Transform { }
ROUTE Source.translation TO I.at  ROUTE Source.translation TO I.to  ROUTE I.at TO Sink.translation)");
  world.start();
  world.send("Source.translation", kFar);
  const Lines trace = world.take();
  for (const char* line : {"0 One.translation 1 2 3", "0 Two.scale 1 2 3", "0 Nested.at 1 2 3", "0 I.at 1 2 3",
                           "0 Sink.translation 1 2 3", "0 Three.center 1 2 3"})
    CHECK(std::count(trace.begin(), trace.end(), line) == 1);
}

TEST_CASE("connects ROUTEs of a PROTO's body per instance, and keeps an exposedField without IS unchanged") {
  World world(R"(
PROTO P [ exposedField SFVec3f loose 0 0 0 eventIn SFVec3f in ] {
  DEF A Transform { set_translation IS in } DEF B Transform { } ROUTE A.translation TO B.translation }
DEF First P { } DEF Second P { })");
  world.start();
  world.send("Second.in", kFar);
  CHECK(world.take() == Lines{"0 A.translation 1 2 3", "0 B.translation 1 2 3"});
  world.send("First.loose", kFar);
  CHECK(world.take() == Lines{"0 First.loose 1 2 3"});
  const NodeId first = world.scene().node(world.node("First")).expansion[0];
  CHECK(world.scene().get<SFVec3f>(first, "translation") == SFVec3f(0));
}

TEST_CASE("runs an EXTERNPROTO from the time at which its body is loaded") {
  World world(
      "EXTERNPROTO E [ eventIn SFVec3f in ] \"e.wrl\" DEF I E { } DEF A Transform { } "
      "ROUTE A.translation TO I.in");
  world.start();
  auto library = std::make_unique<SceneGraph>("e.wrl", world.scene().budget());
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nPROTO E [ eventIn SFVec3f in ] { DEF T Transform { set_translation IS in } }", *library,
              diagnostics);
  const NodeType* body = find_prototype(*library, "E");
  const auto& types = world.scene().types();
  REQUIRE(resolve_external(world.scene(), *types.front(), *body));
  world.scene().attach_library(std::move(library));
  world.execution().scenes().attach();
  world.send("A.translation", kFar);
  CHECK(world.take() == Lines{"0 A.translation 1 2 3", "0 T.translation 1 2 3"});
}

TEST_CASE("adds a child once, and removes it if it is present (4.6.5)") {
  World world(
      "DEF G Group { children DEF A Group { } } DEF B Group { } DEF H Group { } "
      "ROUTE H.children TO G.addChildren");
  world.start();
  world.send("H.children", MFNode{world.node("A"), world.node("B"), world.node("B"), NodeId{}});
  CHECK(world.take("G.") == Lines{"0 G.children [ A, B ]"});
  world.send_at(1, "G.removeChildren", MFNode{world.node("A"), world.node("H")});
  CHECK(world.take() == Lines{"1 G.children [ B ]"});
  world.send_at(2, "G.removeChildren", MFNode{world.node("A")});
  CHECK(world.take().empty());
}

TEST_CASE("replaces a plain field on set_x and sends nothing (6.17, 6.23)") {
  World world("DEF F IndexedFaceSet { } DEF G ElevationGrid { }");
  world.start();
  world.send("F.set_coordIndex", MFInt32{0, 1, 2, -1});
  world.send("G.set_height", MFFloat{1, 2});
  CHECK(world.take().empty());
  CHECK(world.scene().get<MFInt32>(world.node("F"), "coordIndex").size() == 4);
  CHECK(world.scene().get<MFFloat>(world.node("G"), "height") == MFFloat{1, 2});
}

TEST_CASE("sends large values without a copy") {
  World world("DEF A Coordinate { } DEF B Coordinate { } ROUTE A.point TO B.point");
  world.start();
  MFVec3f points;
  points.resize(100'000);
  world.send("A.point", points);
  CHECK(world.scene().get<MFVec3f>(world.node("B"), "point").shares_with(points));
}

TEST_CASE("reports each changed node once, with its slots") {
  World world("DEF A Transform { } DEF B Transform { } DEF T TimeSensor { } ROUTE A.translation TO B.translation");
  world.start();
  CHECK(world.execution().changes().take().empty());
  world.send("A.translation", kFar);
  world.send_at(1, "A.scale", kFar);
  const auto changes = world.execution().changes().take();
  REQUIRE(changes.size() == 2);
  CHECK(changes[0].node == world.node("A"));
  const NodeType& type = *built_in_node_type("Transform");
  CHECK(changes[0].slots ==
        (std::uint64_t{1} << type.find("translation")->slot | std::uint64_t{1} << type.find("scale")->slot));
  CHECK(changes[1].node == world.node("B"));
  CHECK(world.execution().changes().take().empty());
}

TEST_CASE("names only interfaces in node behaviours that the node types have") {
  // A behaviour of both languages may name interfaces that only one of them has.
  for (const Language language : {Language::vrml97, Language::x3d})
    for (const auto& type : built_in_node_types(language)) {
      if (!type->behaviour) continue;
      INFO(type->name);
      const NodeType* const in_x3d = built_in_node_type(Language::x3d, type->name);
      const NodeType* const in_vrml97 = built_in_node_type(type->name);
      for (const std::string_view name : type->behaviour->events)
        if (!name.empty() && name != "bindTime")
          CHECK(((in_vrml97 && in_vrml97->find(name)) || (in_x3d && in_x3d->find(name))));
    }
}

}  // namespace gs::vrml::traces
