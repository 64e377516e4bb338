// Tests of the viewer's movement in a session: links, clicks, gamepads and 3D mice.
#include "app/session/session.h"

#include "app/window/gamepad.h"
#include "tests/app/one_world.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::session_navigation_test {

using namespace sessions;

namespace {

const std::string kTwoViews = "Viewpoint { position 0 0 10 } DEF V Viewpoint { description \"hill\" position 0 0 77 } ";
const std::string kAnchor =
    "Anchor { url \"#V\" description \"to the hill\" children Shape { geometry Box { size 4 4 1 } } } ";

/// Clicks the left button at a position of the picture of 200 x 100 pixels.
void click(OneWorld& world, float x, float y, double time = kStart + 0.1) {
  for (const Kind kind : {Kind::pointer, Kind::button_down, Kind::button_up})
    world.frame = world.session.step(time += 0.001, input_of({pointer(kind, x, y)}));
}

const Navigation& navigation(const OneWorld& world) { return world.frame.pictures[0].view->navigation; }

}  // namespace

TEST_CASE("follows a link by a jump cut unless the author allows ANY transition (VRML97 6.29)") {
  OneWorld any("NavigationInfo { type [ \"FLY\" \"ANY\" ] } " + kTwoViews + kAnchor, false);
  click(any, 100, 50);
  REQUIRE(navigation(any).transition);
  CHECK(navigation(any).transition->to.position == glm::dvec3(0, 0, 77));
  OneWorld cut("NavigationInfo { type \"FLY\" } " + kTwoViews + kAnchor, false);
  click(cut, 100, 50);
  CHECK_FALSE(navigation(cut).transition);
  CHECK(navigation(cut).pose.position == glm::dvec3(0, 0, 77));
  // A Viewpoint that the user chooses is reached by a transition.
  cut.session.camera().bind_viewpoint(0);
  CHECK(navigation(cut).transition);
}

TEST_CASE("reaches a Viewpoint that the world binds, also while the user moves (VRML97 6.53)") {
  for (const bool moves : {false, true}) {
    INFO(moves);
    OneWorld world("NavigationInfo { type [ \"FLY\" \"ANY\" ] } " + kTwoViews +
                       "DEF T TimeSensor { loop TRUE startTime " + std::to_string(kStart + 0.5) +
                       " } ROUTE T.isActive TO V.set_bind Shape { geometry Sphere { radius 0.1 } }",
                   false);
    if (moves) world.frame = world.session.step(kStart + 0.1, input_of({key(Kind::key_down, 'W')}));
    for (int i = 2; i <= 20; ++i) world.frame = world.session.step(kStart + i * 0.1, input_of({}));
    const double z = navigation(world).pose.position.z;
    CHECK_FALSE(navigation(world).transition);
    // After the jump, the viewer moves one and a half metres at speed 1.
    if (moves) {
      CHECK(z > 70);
      CHECK(z < 77);
    } else {
      CHECK(z == 77);
    }
  }
}

TEST_CASE("shows the description of an Anchor under the pointer (VRML97 6.2)") {
  OneWorld world(kTwoViews + kAnchor);
  CHECK_FALSE(world.session.pointing().pointed().sensor);
  (void)world.session.step(kStart + 0.1, input_of({pointer(Kind::pointer, 100, 50)}));
  CHECK(world.session.pointing().pointed().sensor);
  CHECK(world.session.pointing().pointed().description == "to the hill");
  (void)world.session.step(kStart + 0.2, input_of({pointer(Kind::pointer, 5, 5)}));
  CHECK_FALSE(world.session.pointing().pointed().sensor);
  CHECK(world.session.pointing().pointed().description.empty());
  (void)world.session.step(kStart + 0.3, input_of({pointer(Kind::pointer, 100, 50)}, true));  // over a panel
  CHECK(world.session.pointing().pointed().description.empty());
}

TEST_CASE("starts at the Viewpoint that the fragment of the world's own URL names (VRML97 4.5.2, 6.53)") {
  const ScratchFolder folder;
  const std::string path = folder.write("world.wrl",
                                        "#VRML V2.0 utf8\nViewpoint { } DEF Hill Viewpoint { position 0 0 "
                                        "33 } Shape { geometry Cone { } }\n");
  const std::string odd = folder.write("odd#Hill", "#VRML V2.0 utf8\nViewpoint { position 0 0 5 }\n");
  const auto begins = [](const std::string& given) {
    SessionOptions options;
    options.files = {given};
    Session session(options, {}, [] {});
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    bool living = false;
    std::vector<std::string> told;
    while (!living && std::chrono::steady_clock::now() < deadline) {
      for (const Notice& notice : session.step(world_time(), input_of({})).notices) told.push_back(notice.text);
      living = session.view() && session.view()->document->runtime;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    REQUIRE(living);
    CHECK(told.empty() == (given.find("None") == std::string::npos));
    CHECK_FALSE(session.view()->navigation.transition);
    // The Viewpoint is bound; it does not only set the camera's start.
    const auto& viewpoints = session.view()->list->viewpoints;
    const std::size_t at = session.view()->viewpoint.value_or(99);
    REQUIRE(at < viewpoints.size());
    CHECK(session.view()->document->runtime->bound().viewpoint == &viewpoints[at].scene->node(viewpoints[at].node));
    return session.view()->navigation.pose.position.z;
  };
  CHECK(begins(path) == 10);
  CHECK(begins(path + "#Hill") == 33);
  CHECK(begins(path + "#None") == 10);
  CHECK(begins(odd) == 5);  // a file name may end like this
}

TEST_CASE("moves to and frames the clicked Shape in LOOKAT mode") {
  OneWorld world(
      "NavigationInfo { type \"LOOKAT\" } Viewpoint { } Transform { translation 3 0 0 children Shape { geometry Sphere "
      "{ "
      "radius 0.5 } } } Transform { translation -3 0 -40 children Shape { geometry Sphere { radius 1 } } }",
      false);
  CHECK(navigation(world).mode == NavigationMode::look_at);
  // At 10 units, 50 pixels are 10 tan(pi / 8) units.
  const float x = 100 + 3 / (10 * std::tan(0.392699f)) * 50;
  click(world, 5, 5);  // the sky
  CHECK_FALSE(navigation(world).transition);
  click(world, x, 50);
  REQUIRE(navigation(world).transition);
  const Pose to = navigation(world).transition->to;
  CHECK(navigation(world).pose.position == glm::dvec3(0, 0, 10));  // a transition, not a jump
  const glm::dvec3 away = to.position - glm::dvec3(3, 0, 0);
  CHECK(glm::length(away) > 0.9);  // outside, and near enough to fill a third of the picture
  CHECK(glm::length(away) < 0.5 / std::tan(0.392699) * 3);
  CHECK(glm::dot(glm::normalize(away), glm::normalize(glm::dvec3(-3, 0, 10))) > 0.9999);  // from the earlier direction
  CHECK(glm::dot(glm::dvec3(to.forward()), glm::normalize(-away)) > 0.9999);
  CHECK(std::abs(to.right().y) < 1e-5f);  // level
  for (int i = 1; i <= 60; ++i) world.frame = world.session.step(kStart + 0.1 + i / 60.0, input_of({}));
  CHECK(glm::distance(navigation(world).pose.position, to.position) < 1e-9);
  CHECK(glm::distance(navigation(world).center, glm::dvec3(3, 0, 0)) < 1e-5);  // the new centre of rotation
  // A drag does not count as a click.
  const glm::dvec3 before = navigation(world).pose.position;
  (void)world.session.step(kStart + 2, input_of({pointer(Kind::button_down, 100, 50)}));
  (void)world.session.step(kStart + 2, input_of({pointer(Kind::pointer, 140, 50)}));
  world.frame = world.session.step(kStart + 2, input_of({pointer(Kind::button_up, 140, 50)}));
  CHECK_FALSE(navigation(world).transition);
  CHECK(glm::distance(navigation(world).pose.position, before) > 0.1);
}

TEST_CASE("prefers sensors in LOOKAT mode, and ignores clicks in other modes") {
  OneWorld sensor("NavigationInfo { type \"LOOKAT\" } " + kTwoViews +
                      "Group { children [ Shape { geometry Box { } } TouchSensor { } ] }",
                  false);
  sensor.watch();
  click(sensor, 100, 50);
  CHECK(sensor.number_of_events("touchTime") == 1);
  CHECK_FALSE(navigation(sensor).transition);
  OneWorld examine("NavigationInfo { type [ \"EXAMINE\" \"ANY\" ] } Shape { geometry Box { } }", false);
  click(examine, 100, 50);
  CHECK_FALSE(navigation(examine).transition);
  // A key switches the mode on and off.
  examine.frame = examine.session.step(kStart + 1, input_of({key(Kind::key_down, '5')}));
  CHECK(navigation(examine).mode == NavigationMode::look_at);
  click(examine, 100, 50, kStart + 2);
  CHECK(navigation(examine).transition);
}

TEST_CASE("moves nearer when the user clicks on a surrounding object") {
  OneWorld world("NavigationInfo { type \"LOOKAT\" } Viewpoint { } Shape { geometry Box { size 60 60 60 } }", false);
  click(world, 100, 50);
  REQUIRE(navigation(world).transition);
  const Pose to = navigation(world).transition->to;
  CHECK(to.position.z > -29);  // the wall is at -30, 40 ahead
  CHECK(to.position.z < 0);
  CHECK(glm::distance(navigation(world).center, glm::dvec3(0, 0, -30)) < 1e-3);
}

TEST_CASE("moves the viewer by a gamepad as by keys, with buttons as actions") {
  const std::string body = "NavigationInfo { type \"FLY\" speed 2 } " + kTwoViews + "Shape { geometry Box { } }";
  OneWorld stick(body), keys(body);
  Gamepad gamepad;
  GamepadState state;
  state.connected = true;
  state.axes[1] = -1;  // ahead
  stick.frame = stick.session.step(kStart, input_of(gamepad.take(state, 0)));
  keys.frame = keys.session.step(kStart, input_of({key(Kind::key_down, 'W')}));
  CHECK(stick.frame.moving);
  for (int i = 1; i <= 60; ++i)
    for (OneWorld* world : {&stick, &keys}) world->frame = world->session.step(kStart + i / 60.0, input_of({}));
  CHECK(stick.place() == keys.place());
  CHECK(stick.place().z < 9);
  state.axes[1] = 0;
  stick.frame = stick.session.step(kStart + 1, input_of(gamepad.take(state, 1)));
  for (int i = 1; i <= 120; ++i) stick.frame = stick.session.step(kStart + 1 + i / 60.0, input_of({}));
  CHECK_FALSE(stick.frame.moving);
  state.buttons[5] = true;  // the right bumper
  stick.frame = stick.session.step(kStart + 4, input_of(gamepad.take(state, 4)));
  CHECK(stick.session.view()->viewpoint == 1u);
  CHECK(navigation(stick).pose.position == glm::dvec3(0, 0, 77));
}

}  // namespace gs::app::session_navigation_test
