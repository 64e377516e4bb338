#include "app/window/gamepad.h"

#include "app/view/actions.h"
#include "app/view/input_tracker.h"

#include <catch2/catch.hpp>

namespace gs::app::gamepad_test {
namespace {

using Kind = WindowEvent::Kind;

GamepadState connected() { return {.connected = true}; }

}  // namespace

TEST_CASE("reports nothing for a gamepad at rest or a missing one") {
  Gamepad gamepad;
  CHECK(gamepad.take({}, 0).empty());
  CHECK(gamepad.take(connected(), 1).empty());
  GamepadState worn = connected();
  worn.axes = {0.1f, -0.1f, 0.12f, 0, -0.9f, -1};
  CHECK(gamepad.take(worn, 2).empty());
  worn.axes[0] = NAN;
  CHECK(gamepad.take(worn, 3).empty());
}

TEST_CASE("moves and turns by sticks, and down and up by triggers, gently at first") {
  Gamepad gamepad;
  GamepadState state = connected();
  state.axes = {1, 0, 0, -1, -1, 1};
  std::vector<WindowEvent> events = gamepad.take(state, 4);
  REQUIRE(events.size() == 1);
  CHECK(events[0].kind == Kind::axes);
  CHECK(events[0].time == 4);
  CHECK(events[0].move == glm::vec3(1, 1, 0));
  CHECK(events[0].turn == glm::vec2(0, 1));
  CHECK(gamepad.take(state, 5).empty());  // held
  state.axes = {0, -1, 0, 0, 1, -1};
  events = gamepad.take(state, 6);
  REQUIRE(events.size() == 1);
  CHECK(events[0].move == glm::vec3(0, -1, 1));
  CHECK(events[0].turn == glm::vec2(0));
  state.axes = {0, -0.5f, 0, 0, -1, -1};
  events = gamepad.take(state, 7);
  REQUIRE(events.size() == 1);
  CHECK(events[0].move.z > 0.05f);
  CHECK(events[0].move.z < 0.5f);
  // The gamepad is unplugged while a stick is held.
  events = gamepad.take({}, 8);
  REQUIRE(events.size() == 1);
  CHECK(events[0].move == glm::vec3(0));
}

TEST_CASE("maps buttons to keys that go down once and up once") {
  Gamepad gamepad;
  for (const GamepadButtonRow& row : gamepad_buttons()) {
    CAPTURE(row.name);
    GamepadState state = connected();
    state.buttons[row.button] = true;
    std::vector<WindowEvent> events = gamepad.take(state, 1);
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == Kind::key_down);
    CHECK(events[0].key == row.key);
    CHECK((action_of(events[0]) != nullptr || row.key == Key::shift));  // each button has an action, or acts while held
    CHECK(gamepad.take(state, 2).empty());
    events = gamepad.take(connected(), 3);
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == Kind::key_up);
  }
}

TEST_CASE("moves by a held gamepad input as by held keys") {
  Gamepad gamepad;
  InputTracker tracker;
  GamepadState state = connected();
  state.axes = {0, -1, 1, 0, -1, -1};
  const auto feed = [&](const GamepadState& held) {
    for (const WindowEvent& event : gamepad.take(held, 0)) (void)tracker.take(event, NavigationMode::walk);
    return tracker.input(NavigationMode::walk, Viewport{0, 0, 100, 100});
  };
  NavigationInput input = feed(state);
  CHECK(input.move == glm::vec3(0, 0, 1));
  CHECK(input.turn == glm::vec2(1, 0));
  CHECK(tracker.holding());
  // Gamepad and keys together are no faster than the maximum.
  WindowEvent key;
  key.kind = Kind::key_down;
  key.key = letter_key('W');
  (void)tracker.take(key, NavigationMode::walk);
  CHECK(feed(state).move == glm::vec3(0, 0, 1));
  key.kind = Kind::key_up;
  (void)tracker.take(key, NavigationMode::walk);
  input = feed(connected());
  CHECK_FALSE(input.any());
  CHECK_FALSE(tracker.holding());
  (void)feed(state);
  tracker.release();
  CHECK_FALSE(tracker.holding());
}

}  // namespace gs::app::gamepad_test
