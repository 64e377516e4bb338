#include "tests/vrml/events/trace.h"
#include "vrml/behaviours/browser_events.h"

#include <utility>

namespace gs::vrml::traces {
namespace world_browser_test {

namespace {

std::string printed(const std::string& body) {
  World world(body);
  return print(world.scene());
}

}  // namespace

TEST_CASE("ROUTEs take Browser as a node, in files and in PROTO bodies (Contact)") {
  World world(
      "PROTO P [ eventOut SFVec3f place ] { DEF I PositionInterpolator { } DEF T Transform { } ROUTE "
      "Browser.viewpointPosition TO T.set_translation } DEF T Transform { } ROUTE Browser.viewpointPosition_changed TO "
      "T.translation P { } DEF F ScalarInterpolator { } ROUTE Browser.windowAspect TO F.set_fraction Viewpoint { "
      "position 1 2 3 }");
  world.start();
  (void)world.take();
  world.step(1);
  CHECK(world.take("T.translation") == Lines{"1 T.translation 1 2 3", "1 T.translation 1 2 3"});
  world.step(2);
  CHECK(world.take().empty());
  world.execution().browser().set_view({{200, 100}, "WALK", 1});
  world.step(3);
  CHECK(world.take("windowAspect") == Lines{"3 Browser.windowAspect 2"});
}

TEST_CASE("a node that is called Browser has precedence over the browser") {
  World world("DEF Browser Transform { } DEF T Transform { } ROUTE Browser.translation_changed TO T.set_translation");
  world.start();
  world.send("Browser.translation", SFVec3f(1, 2, 3));
  CHECK(world.take("T.") == Lines{"0 T.translation 1 2 3"});
}

TEST_CASE("prints ROUTEs of the Browser so that they can be read again") {
  const std::string again = printed("DEF T Transform { } ROUTE Browser.viewpointPosition TO T.set_translation");
  CHECK(again.find("ROUTE Browser.viewpointPosition TO T.translation") != std::string::npos);
  CHECK(printed(again.substr(again.find('\n') + 1)) == again);
}

TEST_CASE("reports an unknown event of the Browser in a ROUTE") {
  SceneGraph scene("text.wrl");
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nDEF T Transform { } ROUTE Browser.nothing TO T.translation", scene, diagnostics);
  REQUIRE(diagnostics.errors() == 1);
  CHECK(diagnostics.entries()[0].text().find("Browser has no eventOut 'nothing'") != std::string::npos);
}

TEST_CASE("events of the Browser request moves of the viewer, and cannot resize the window") {
  World world(
      "DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 5 0 0, 7 0 0 ] } DEF F ScalarInterpolator { key [ 0 1 ] "
      "keyValue [ 3 3 ] } ROUTE P.value_changed TO Browser.set_viewpointPosition ROUTE F.value_changed TO "
      "Browser.windowAspect");
  world.start();
  world.step(1);
  CHECK_FALSE(world.execution().browser().waits());
  world.send("P.set_fraction", 0.5f);
  world.send("F.set_fraction", 0.5f);
  CHECK(world.take("Browser.") == Lines{"1 Browser.viewpointPosition 6 0 0"});
  CHECK(world.execution().browser().waits());
  CHECK(world.execution().next_time() == world.execution().now());
  const auto move = world.execution().browser().take_move();
  REQUIRE(move);
  CHECK(glm::dvec3((*move)[3]) == glm::dvec3(6, 0, 0));
}

TEST_CASE("sends inputs to all ROUTEs of event_changed, by default keys and buttons") {
  World world(
      "PROTO P [ eventOut SFNode e ] { DEF S Script { eventIn SFNode e } ROUTE Browser.event_changed TO S.e } P { } P "
      "{ "
      "} DEF S Script { eventIn SFNode e } ROUTE Browser.event_changed TO S.e");
  world.start();
  world.step(1);
  (void)world.take();
  WorldBrowser& browser = world.execution().browser();
  CHECK_FALSE(browser.send_input({BrowserInputKind::mousemove}));
  CHECK(world.take().empty());
  CHECK_FALSE(browser.send_input({BrowserInputKind::keydown, 65}));
  CHECK(world.take("event_changed").size() == 3);
  CHECK(browser.is_pressed(65));
  CHECK_FALSE(browser.send_input({BrowserInputKind::keyup, 65}));
  CHECK_FALSE(browser.is_pressed(65));
  for (const int odd : {-1, 0, 256, 1 << 30}) CHECK_FALSE(browser.is_pressed(odd));
  (void)world.take();
  browser.set_event_mask(1 << 1);
  CHECK_FALSE(browser.send_input({BrowserInputKind::keydown, 65}));
  CHECK(world.take().empty());
  (void)browser.send_input({BrowserInputKind::mousemove});
  CHECK(world.take("event_changed").size() == 3);
  CHECK(world.scene().nodes().count() < 20);  // one event node for all
}

TEST_CASE("IS and ROUTE know bind of bindable nodes, as set_bind") {
  World world(
      "PROTO P [ eventIn SFBool go eventOut SFBool is ] { Viewpoint { bind IS go isBound IS is } } Viewpoint { } DEF A "
      "P { } DEF B Viewpoint { } DEF T TimeSensor { } ROUTE T.isActive TO B.bind");
  world.start();
  (void)world.take();
  world.step(1);
  world.send("A.go", true);
  CHECK(world.take("A.is") == Lines{"1 A.is TRUE"});
  world.step(2);
  world.send("T.startTime", World::kStart + 3);
  world.step(3);
  CHECK(world.take("B.isBound") == Lines{"3 B.isBound TRUE"});
}

TEST_CASE("a movie sends mediaTime while it is active and a node listens (Contact)") {
  World world(
      "PROTO P [ eventOut SFTime time ] { MovieTexture { url \"a.mpg\" startTime 1001 mediaTime IS time } } Shape { "
      "appearance Appearance { texture DEF P P { } } } DEF S Script { eventIn SFTime t } DEF N MovieTexture { url "
      "\"b.mpg\" startTime 1001 } ROUTE P.time TO S.t");
  world.start();
  REQUIRE(report_media(world.execution(), world.scene(), world.scene().node(world.node("P")).expansion[0], 4));
  (void)world.take();
  world.step(1);
  CHECK(world.take("P.time") == Lines{"1 P.time 0"});
  world.step(2.5);
  CHECK(world.take("P.time") == Lines{"2.5 P.time 1.5"});
  CHECK(world.execution().next_time() == world.execution().now());
  world.step(5);
  CHECK(world.take("ediaTime").empty());
  world.step(6);
  CHECK(world.take().empty());
  CHECK(world.execution().next_time() != world.execution().now());
}

TEST_CASE("an Inline sends children_changed with itself when its content is present") {
  const auto content = [] {
    auto made = std::make_unique<SceneGraph>("part.wrl");
    Diagnostics diagnostics;
    (void)parse("#VRML V2.0 utf8\nGroup { }", *made, diagnostics);
    return made;
  };
  World world(
      "DEF I Inline { url \"part.wrl\" } DEF G Group { } ROUTE I.children_changed TO G.set_children DEF J Inline { } "
      "DEF H Group { }");
  world.start();
  CHECK(world.take().empty());
  for (const int at : {1, 2}) {
    world.step(at);
    world.execution().lifetime().remove_content(world.scene(), world.node("I"));
    world.scene().inlines().attach(world.node("I"), content());
    world.execution().scenes().attach(world.scene());
    CHECK(world.execution().next_time().value_or(0) <= world.execution().now());
    world.step(at + 0.5);
    CHECK(world.take("children_changed") ==
          Lines{(at == 1 ? "1.5" : "2.5") + std::string(" I.children_changed [ I ]")});
  }
  // A ROUTE that is added later gets the event at once.
  world.scene().inlines().attach(world.node("J"), content());
  world.execution().scenes().attach(world.scene());
  world.step(3);
  CHECK(world.take().empty());
  const Node &from = world.scene().node(world.node("J")), &to = world.scene().node(world.node("H"));
  CHECK(world.execution().routes().add(world.scene(),
                                       {world.node("J"), world.node("H"), from.type->find_event_out("children_changed"),
                                        to.type->find_event_in("set_children")}));
  world.step(4);
  CHECK(world.take("J.children_changed") == Lines{"4 J.children_changed [ J ]"});
}

}  // namespace world_browser_test
}  // namespace gs::vrml::traces
