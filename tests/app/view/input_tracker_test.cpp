#include "app/view/input_tracker.h"

#include "tests/app/window_events.h"

#include <catch2/catch.hpp>

namespace {

using namespace gs::app;

WindowEvent key(EventKind kind, Key which) {
  WindowEvent result = event(kind);
  result.key = which;
  return result;
}
const Viewport kPlace{0, 34, 800, 600};

}  // namespace

TEST_CASE("reports a drag while the button is down") {
  InputTracker tracker;
  tracker.take(event(EventKind::pointer, {50, 50}), NavigationMode::examine);
  tracker.take(event(EventKind::button_down, {100, 100}), NavigationMode::examine);
  CHECK(tracker.input(NavigationMode::examine, kPlace).drag == Drag::none);
  tracker.take(event(EventKind::pointer, {110, 95}), NavigationMode::examine);
  tracker.take(event(EventKind::pointer, {130, 90}), NavigationMode::examine);
  NavigationInput input = tracker.input(NavigationMode::examine, kPlace);
  CHECK(input.drag == Drag::rotate);
  CHECK(input.moved == glm::vec2(30, -10));
  CHECK(tracker.input(NavigationMode::examine, kPlace).drag == Drag::none);

  // A press and release within one frame count too.
  tracker.take(event(EventKind::pointer, {131, 90}), NavigationMode::examine);
  tracker.take(event(EventKind::button_up, {131, 90}), NavigationMode::examine);
  tracker.take(event(EventKind::pointer, {300, 300}), NavigationMode::examine);
  input = tracker.input(NavigationMode::examine, kPlace);
  CHECK(input.drag == Drag::rotate);
  CHECK(input.moved == glm::vec2(1, 0));
  CHECK(tracker.input(NavigationMode::examine, kPlace).drag == Drag::none);
}

TEST_CASE("ends a drag only by the button that began it") {
  InputTracker tracker;
  tracker.take(event(EventKind::button_down, {0, 0}, MouseButton::right), NavigationMode::examine);
  tracker.take(event(EventKind::button_down, {0, 0}, MouseButton::left), NavigationMode::examine);
  tracker.take(event(EventKind::button_up, {0, 0}, MouseButton::left), NavigationMode::examine);
  tracker.take(event(EventKind::pointer, {5, 0}), NavigationMode::examine);
  CHECK(tracker.input(NavigationMode::examine, kPlace).drag == Drag::pan);
}

TEST_CASE("continues a travelling drag while the pointer rests") {
  InputTracker tracker;
  tracker.take(event(EventKind::button_down, {100, 100}), NavigationMode::walk);
  tracker.take(event(EventKind::pointer, {100, 60}), NavigationMode::walk);
  (void)tracker.input(NavigationMode::walk, kPlace);
  const NavigationInput input = tracker.input(NavigationMode::walk, kPlace);
  CHECK(input.drag == Drag::travel);
  CHECK(input.from_press == glm::vec2(0, -40));
  CHECK(tracker.holding());
  CHECK(tracker.travel_anchor() == glm::vec2(100, 100));
  tracker.release();
  CHECK_FALSE(tracker.holding());
  CHECK(tracker.input(NavigationMode::walk, kPlace).drag == Drag::none);
}

TEST_CASE("zooms towards the point under the pointer by wheel, and by Ctrl and the middle button") {
  InputTracker tracker;
  WindowEvent wheel = event(EventKind::wheel, {10, 10});
  wheel.wheel = 2;
  CHECK(tracker.take(wheel, NavigationMode::examine).needs_target);
  tracker.set_target({1, 2, 3});
  const NavigationInput input = tracker.input(NavigationMode::examine, kPlace);
  CHECK(input.zoom == 2);
  CHECK(input.target == glm::dvec3(1, 2, 3));
  WindowEvent down = event(EventKind::button_down, {0, 100}, MouseButton::middle);
  down.control = true;
  CHECK(tracker.take(down, NavigationMode::examine).needs_target);
  tracker.take(event(EventKind::pointer, {0, 60}), NavigationMode::examine);
  CHECK(tracker.input(NavigationMode::examine, kPlace).zoom == Approx(2));
}

TEST_CASE("reports two quick clicks at one position as a double click, but not a third") {
  InputTracker tracker;
  const auto click = [&](double time, float x) {
    const bool result =
        tracker.take(event(EventKind::button_down, {x, 0}, MouseButton::left, time), NavigationMode::examine)
            .double_click;
    tracker.take(event(EventKind::button_up, {x, 0}), NavigationMode::examine);
    return result;
  };
  CHECK_FALSE(click(1.0, 5));
  CHECK(click(1.2, 6));
  CHECK_FALSE(click(1.4, 6));
  CHECK_FALSE(click(3.0, 6));
  CHECK_FALSE(click(3.1, 60));
}

TEST_CASE("maps held keys to directions, and releases them with the focus") {
  InputTracker tracker;
  tracker.take(key(EventKind::key_down, letter_key('W')), NavigationMode::fly);
  tracker.take(key(EventKind::key_down, Key::left), NavigationMode::fly);
  NavigationInput input = tracker.input(NavigationMode::fly, kPlace);
  CHECK(input.move == glm::vec3(0, 0, 1));
  CHECK(input.turn == glm::vec2(-1, 0));
  tracker.take(key(EventKind::key_down, Key::up), NavigationMode::fly);
  CHECK(tracker.input(NavigationMode::fly, kPlace).move.z == 1);
  CHECK(tracker.input(NavigationMode::examine, kPlace).turn == glm::vec2(-1, 1));
  tracker.take(key(EventKind::key_down, Key::shift), NavigationMode::fly);
  CHECK(tracker.input(NavigationMode::fly, kPlace).fast);
  CHECK(tracker.holding());
  tracker.take(event(EventKind::focus_lost), NavigationMode::fly);
  CHECK_FALSE(tracker.input(NavigationMode::fly, kPlace).any());
  CHECK_FALSE(tracker.holding());
}
