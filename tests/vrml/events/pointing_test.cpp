#include "tests/vrml/events/pointer.h"
#include "vrml/behaviours/browser_events.h"

namespace gs::vrml::traces {
namespace {

Lines names(World& world, std::string_view event) {
  Lines result;
  for (const std::string& line : world.take(event)) result.push_back(line.substr(line.find(' ') + 1));
  return result;
}

// Clicks a shape, and returns the events of its sensors.
Lines clicked(World& world, PointingDevice& device, std::string_view shape, int at) {
  world.step(at);
  device.press(shape, at, 0);
  const Lines heard = names(world, "isActive TRUE");
  world.step(at + 0.5);
  device.release();
  (void)world.take();
  return heard;
}

std::string anchors(World& world) {
  std::string text;
  for (const NodePlace& place : world.execution().pointing().take_requests())
    text += std::string(place.scene->node(place.node).name) + ' ';
  return text;
}

}  // namespace

TEST_CASE("sends the click to the lowest level with a pointing-device sensor, including Anchors (4.6.7.3)") {
  // This is the example in the standard.
  World world(R"(Group { children [
    DEF Shape1 Shape { } DEF SensorA TouchSensor { } DEF SensorB PlaneSensor { }
    DEF AnchorA Anchor { url "..." description "Away" children [
      DEF Shape2 Shape { } DEF SensorC TouchSensor { }
      Group { children [ DEF Shape3 Shape { } DEF SensorD TouchSensor { } ] } ] } ] })");
  world.start();
  PointingDevice device(world);
  CHECK(clicked(world, device, "Shape3", 1) == Lines{"SensorD.isActive TRUE"});
  CHECK(anchors(world).empty());
  CHECK(clicked(world, device, "Shape2", 2) == Lines{"SensorC.isActive TRUE"});
  CHECK(world.execution().pointing().pointed_at().description == "Away");
  CHECK(anchors(world) == "AnchorA ");
  CHECK(anchors(world).empty());
  CHECK(clicked(world, device, "Shape1", 3) == Lines{"SensorA.isActive TRUE", "SensorB.isActive TRUE"});
  CHECK(world.execution().pointing().pointed_at().description.empty());
  // Disabled sensors are ignored.
  world.send("SensorD.enabled", false);
  CHECK(clicked(world, device, "Shape3", 4) == Lines{"SensorC.isActive TRUE"});
  CHECK(anchors(world) == "AnchorA ");
  world.send("SensorA.enabled", false);
  CHECK(clicked(world, device, "Shape1", 5) == Lines{"SensorB.isActive TRUE"});
}

TEST_CASE("activates an Anchor only if the button is released over it (6.2)") {
  World world("DEF A Anchor { url \"a\" children DEF S Shape { } } DEF B Anchor { children DEF R Shape { } }");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.move("S", 0, 0);
  CHECK(world.execution().pointing().pointed_at().anchor.node == world.node("A"));
  device.press();
  CHECK(anchors(world).empty());
  world.step(2);
  device.move("R", 1, 0);
  CHECK_FALSE(world.execution().pointing().pointed_at().sensor);  // A has grabbed the pointer
  device.release();
  CHECK(anchors(world).empty());
  CHECK(world.execution().pointing().pointed_at().anchor.node == world.node("B"));
  CHECK(world.take().empty());
  for (int i = 0; i < 200; ++i) {
    world.step(3 + i);
    device.press();
    device.release();
  }
  CHECK(world.execution().pointing().take_requests().size() == Pointing::kMaxRequests);
}

TEST_CASE("activates the innermost of nested Anchors (6.2)") {
  World world("DEF A Anchor { url \"a\" children [ DEF S Shape { } DEF B Anchor { children DEF R Shape { } } ] }");
  world.start();
  PointingDevice device(world);
  (void)clicked(world, device, "R", 1);
  CHECK(anchors(world) == "B ");
  (void)clicked(world, device, "S", 2);
  CHECK(anchors(world) == "A ");
}

TEST_CASE("applies sensors at top level, in PROTO instances and in Inlines to their siblings (4.6.7.3)") {
  World world(R"(PROTO Touched [ eventOut SFBool isOver exposedField MFNode children [ ] ]
    { Transform { translation 1 0 0 children [ Group { children IS children } TouchSensor { isOver IS isOver } ] }
      DEF Unplaced TouchSensor { } }
    PROTO Sensor [ eventOut SFBool isOver ] { TouchSensor { isOver IS isOver } }
    DEF P Touched { children DEF S Shape { } }
    Group { children [ DEF R Shape { } DEF Q Sensor { } ] }
    DEF I Inline { } DEF Alone Shape { } DEF Top TouchSensor { })");
  auto content = std::make_unique<SceneGraph>("inline.wrl", world.scene().budget());
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nDEF InS Shape { } DEF InT TouchSensor { }", *content, diagnostics);
  SceneGraph& inlined = *content;
  world.scene().inlines().attach(world.node("I"), std::move(content));
  world.execution().scenes().attach();
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.move("S", 2, 0);
  CHECK(names(world, "isOver") == Lines{"TouchSensor#1.isOver TRUE", "P.isOver TRUE"});
  world.step(2);
  device.move("R", 3, 0);
  CHECK(names(world, "Q.isOver") == Lines{"Q.isOver TRUE"});
  world.step(3);
  device.move("Alone", 4, 0);
  CHECK(names(world, "Top.") == Lines{"Top.isOver TRUE", "Top.hitPoint_changed 4 0 0", "Top.hitNormal_changed 0 0 1",
                                      "Top.hitTexCoord_changed 0.25 0.5"});
  world.step(4);
  device.at("Alone", 5, 0);
  device.over(inlined, inlined.roots()[0]);
  device.tell();
  CHECK(names(world, "isOver") == Lines{"Top.isOver FALSE", "InT.isOver TRUE"});
}

TEST_CASE("drags a sensor of several groups in the coordinate system of the group under the pointer (4.6.7.3)") {
  World world(R"(Transform { translation 1 0 0 children [ DEF A Shape { } DEF T TouchSensor { } USE T ] }
    Transform { translation 2 0 0 children [ DEF B Shape { } USE T DEF P PlaneSensor { } ] })");
  world.start();
  PointingDevice device(world);
  device.move("A", 1, 0);
  CHECK(world.take("hitPoint") == Lines{"0 T.hitPoint_changed 0 0 0"});
  world.step(1);
  device.move("B", 5, 0);
  CHECK(world.take() ==
        Lines{"1 T.hitPoint_changed 3 0 0", "1 T.hitNormal_changed 0 0 1", "1 T.hitTexCoord_changed 0.25 0.5"});
  world.step(2);
  device.press();
  world.step(3);
  device.move("A", 1, 1);
  CHECK(world.take() == Lines{"2 T.isActive TRUE", "2 P.isActive TRUE", "3 T.hitPoint_changed 0 1 0",
                              "3 T.hitNormal_changed 0 0 1", "3 T.hitTexCoord_changed 0.25 0.5",
                              "3 P.trackPoint_changed -1 1 0", "3 P.translation_changed -4 1 0"});
}

TEST_CASE("sends pointer events only to the sensors that grabbed the pointer (4.6.7.5)") {
  World world(R"(Group { children [ DEF A Shape { } DEF T TouchSensor { } DEF P PlaneSensor { } ] }
    Group { children [ DEF B Shape { } DEF U TouchSensor { } ] })");
  world.start();
  PointingDevice device(world);
  device.press("A", 0, 0);
  (void)world.take();
  world.step(1);
  device.move("B", 1, 0);
  CHECK(world.take() == Lines{"1 T.isOver FALSE", "1 P.trackPoint_changed 1 0 0", "1 P.translation_changed 1 0 0"});
  // After one sensor is disabled, the other one continues alone.
  world.send_at(2, "P.enabled", false);
  CHECK(world.take() == Lines{"2 P.enabled FALSE", "2 P.isActive FALSE"});
  device.move("B", 2, 0);
  CHECK(world.take().empty());
  world.step(3);
  device.release("B", 3, 0);
  CHECK(world.take() == Lines{"3 T.isActive FALSE", "3 U.isOver TRUE", "3 U.hitPoint_changed 3 0 0",
                              "3 U.hitNormal_changed 0 0 1", "3 U.hitTexCoord_changed 0.25 0.5"});
}

TEST_CASE("finds sensors in long lists of children once, and again after a change (4.6.7.3)") {
  std::string text = "DEF G Group { children [ DEF T TouchSensor { }";
  for (int i = 0; i < 500; ++i) text += " DEF S" + std::to_string(i) + " Shape { }";
  World world(text + " ] } DEF More TouchSensor { }");
  world.start();
  PointingDevice device(world);
  CHECK(clicked(world, device, "S400", 1) == Lines{"T.isActive TRUE"});
  world.send("G.addChildren", MFNode{world.node("More")});
  CHECK(clicked(world, device, "S401", 2) == Lines{"T.isActive TRUE", "More.isActive TRUE"});
  world.send("G.removeChildren", MFNode{world.node("T")});
  CHECK(clicked(world, device, "S402", 3) == Lines{"More.isActive TRUE"});
}

TEST_CASE("treats invalid paths as a pointer over nothing") {
  World world(
      "Switch { whichChoice 0 choice [ DEF S Shape { } DEF T TouchSensor { } ] } LOD { level TouchSensor { } }");
  SceneGraph stranger("stranger.wrl");
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nShape { } TouchSensor { }", stranger, diagnostics);
  world.start();
  PointingDevice device(world);
  device.move("S", 0, 0);
  device.path() = {{nullptr, {}, glm::dmat4(1)},
                   {&stranger, stranger.roots()[0], glm::dmat4(1)},
                   {&world.scene(), NodeId{999, 1}, glm::dmat4(1)}};
  device.press();
  device.release();
  CHECK(world.take().empty());
}

TEST_CASE("sends collideTime when the avatar meets children of a Collision node, unless collide is FALSE (6.8)") {
  World world(R"(DEF A Collision { children Group { children DEF B Collision { children DEF S Shape { } } } }
    DEF C Collision { collide FALSE children DEF D Collision { children DEF R Shape { } } })");
  world.start();
  PointingDevice device(world);
  world.step(1);
  device.at("S", 0, 0);
  CHECK(collide(world.execution(), device.path()));
  CHECK(world.take() == Lines{"1 A.collideTime 1001", "1 B.collideTime 1001"});
  device.at("R", 0, 0);
  CHECK_FALSE(collide(world.execution(), device.path()));
  CHECK(world.take().empty());
  world.send_at(2, "C.collide", true);
  CHECK(collide(world.execution(), device.path()));
  CHECK(world.take("collideTime") == Lines{"2 C.collideTime 1002", "2 D.collideTime 1002"});
}

}  // namespace gs::vrml::traces
