// Tests of Scripts that change the view of their world, and that receive the user's input (Contact's Browser object).
#include "app/session/navigation/script_effects.h"

#include "tests/app/one_world.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>
#include <vector>

namespace gs::app::script_effects_test {

using namespace sessions;

namespace {

/// World with a Script that runs `program` in initialize() and `go` for the event of a TimeSensor after half a second.
struct ScriptWorld : OneWorld {
  ScriptWorld(const std::string& initialize, const std::string& go, const std::string& rest = {})
      : OneWorld(rest + "DEF C TimeSensor { startTime " + std::to_string(kStart + 0.5) +
                     " loop TRUE } DEF S Script { directOutput TRUE field SFNode me USE S eventIn SFBool go eventIn "
                     "SFNode ev eventOut SFBool is url \"javascript: function initialize() { " +
                     initialize + " } function go() { " + go +
                     " } function ev(e) { print(e.type + e.keyCode); if (e.keyCode == 71) e.returnValue = false; }\" } "
                     "ROUTE C.isActive TO S.go",
                 true) {
    watch_prints();
  }
  void watch_prints() {
    document->runtime->programs().observe([this](const ScriptMessage& message) {
      printed.push_back(message.printed ? message.diagnostic.message : message.diagnostic.text());
    });
  }
  void step(double at, std::vector<WindowEvent> input = {}) {
    frame = session.step(kStart + at, input_of(std::move(input)));
  }
  [[nodiscard]] const Navigation& navigation() const { return frame.pictures[0].view->navigation; }
  std::vector<std::string> printed;
};

using Lines = std::vector<std::string>;

const std::string kBox =
    "DEF G Group { children DEF T Transform { translation 1 0 0 children DEF H Shape { geometry "
    "Box { } } } } ";

}  // namespace

TEST_CASE("a Script moves the viewer at once, and sensors notice (Contact)") {
  ScriptWorld world("", "Browser.setViewpointByValue(new SFVec3f(0, 2, 30), new SFRotation(0, 1, 0, 1.57079633));",
                    "Viewpoint { position 0 0 10 } DEF P ProximitySensor { center 0 2 30 size 4 4 4 } ");
  world.watch();
  world.step(0.6);
  CHECK(world.place() == glm::vec3(0, 2, 30));
  CHECK(world.navigation().pose.forward().x < -0.99f);
  world.step(0.7);
  CHECK(world.number_of_events("isActive") >= 2);  // of the clock and of the sensor
  CHECK(world.document->runtime->execution().viewer().pose()[3].z == 30);
}

TEST_CASE("a Script changes the navigation mode, also to one that the user may not choose (Contact)") {
  ScriptWorld world("", "print(Browser.getNavigationMode()); Browser.setNavigationMode('fly');",
                    "NavigationInfo { type \"WALK\" } Viewpoint { } ");
  world.step(0.4);
  CHECK(world.navigation().mode == NavigationMode::walk);
  world.step(0.6);
  CHECK(world.navigation().mode == NavigationMode::fly);
  CHECK(world.printed == Lines{"WALK"});
  ScriptWorld unknown("Browser.setNavigationMode('nothing');", "", "Viewpoint { } ");
  const NavigationMode before = unknown.navigation().mode;
  unknown.step(0.6);
  CHECK(unknown.navigation().mode == before);
}

TEST_CASE("a Script turns gravity and collision off (Contact)") {
  const std::string room =
      "NavigationInfo { type \"WALK\" speed 10 } Viewpoint { position 0 1.6 10 } Transform { translation 0 0 5 "
      "children "
      "Shape { geometry Box { size 20 20 0.1 } } } Transform { translation 0 -0.05 0 children Shape { geometry Box { "
      "size 100 0.1 100 } } } ";
  for (const bool solid : {true, false}) {
    INFO(solid);
    ScriptWorld world(solid ? "" : "Browser.setCollisionDetection(false);", "", room);
    WindowEvent up;
    up.kind = Kind::key_down;
    up.key = Key::up;
    world.step(0.1, {up});
    for (int i = 2; i <= 30; ++i) world.step(i * 0.05);
    CHECK((world.place().z < 5) == !solid);
  }
}

TEST_CASE("a Script gets keys by Browser.event_changed, and can keep them from the viewer (Contact)") {
  ScriptWorld world("Browser.eventMask = 3 << 5; Browser.addRoute(Browser, 'event_changed', me, 'ev');", "",
                    "Viewpoint { } ");
  world.step(0.1);
  WindowEvent escape;
  escape.kind = Kind::key_down;
  escape.key = Key::escape;
  world.step(0.2, {key(Kind::key_down, 'G'), key(Kind::key_up, 'G'), key(Kind::key_down, 'X'), escape});
  CHECK(world.printed == Lines{"keydown71", "keyup71", "keydown88", "keydown27"});
  CHECK_FALSE(world.navigation().ghost);  // G would turn collision off
  ScriptWorld deaf("", "", "Viewpoint { } ");
  deaf.step(0.1);
  deaf.step(0.2, {key(Kind::key_down, 'G')});
  CHECK(deaf.navigation().ghost);
}

TEST_CASE("computeRayHit returns point, normal and path of the nearest Shape (Contact)") {
  ScriptWorld world(
      "",
      "var h = Browser.computeRayHit(new SFVec3f(1, 0, 9), new SFVec3f(1, 0, -9)); print(h.hitPoint + ' | ' + "
      "h.hitNormal); for (var i = 0; i < h.hitPath.length; ++i) print(h.hitPath[i].getType() + "
      "h.hitPath[i].getName()); print(Browser.computeRayHit(new SFVec3f(5, 0, 9), new SFVec3f(5, 0, -9)) + ' ' + "
      "Browser.computeRayHit(new SFVec3f(1, 0, 9), new SFVec3f(1, 0, 2)) + ' ' + Browser.computeRayHit(new "
      "SFVec3f(1, 0, 9), new SFVec3f(1, 0, -9), me));",
      kBox + "Viewpoint { } ");
  world.step(0.6);
  CHECK(world.printed == Lines{"1 0 1 | 0 0 1", "GroupG", "TransformT", "ShapeH", "null null null"});
}

TEST_CASE("computeRayHit uses the present places of Shapes (Contact)") {
  ScriptWorld world(
      "",
      "var h = Browser.computeRayHit(new SFVec3f(4, 0, 9), new SFVec3f(4, 0, -9)); print(h ? h.hitPoint.z : 'none');",
      kBox + "Viewpoint { } ");
  const vrml::SceneGraph& scene = *world.document->world.scene;
  const vrml::NodeId moved = scene.get<vrml::MFNode>(scene.roots().front(), "children")[0];
  REQUIRE(world.document->runtime->send(scene, moved, "set_translation", vrml::SFVec3f(4, 0, 3)));
  world.step(0.6);
  CHECK(world.printed == Lines{"4"});
}

TEST_CASE("a Script turns the sound and the animation of Viewpoints off (Contact)") {
  const std::string views = "Viewpoint { position 0 0 10 } DEF V Viewpoint { position 0 0 77 } ROUTE S.is TO V.bind ";
  for (const bool animated : {true, false}) {
    INFO(animated);
    OneWorld world(
        "NavigationInfo { type [ \"FLY\" \"ANY\" ] } DEF S Script { eventIn SFBool go eventOut SFBool is url "
        "\"javascript: function go() { Browser.setSoundEnabled(false); Browser.setViewpointAnimation(" +
            std::string(animated ? "true" : "false") + "); is = true; }\" } DEF C TimeSensor { startTime " +
            std::to_string(kStart + 0.5) + " loop TRUE } ROUTE C.isActive TO S.go " + views,
        false);
    world.frame = world.session.step(kStart + 0.6, input_of({}));
    CHECK(world.frame.pictures[0].view->navigation.transition.has_value() == animated);
    if (!animated) CHECK(world.place() == glm::vec3(0, 0, 77));
    CHECK_FALSE(world.document->runtime->execution().browser().settings().sound);
  }
}

}  // namespace gs::app::script_effects_test
