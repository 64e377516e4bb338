#include "app/window/space_mouse.h"

#include <catch2/catch.hpp>

#include <deque>

namespace gs::app::space_mouse_test {
namespace {

using Kind = WindowEvent::Kind;

// Events of the fake daemon, which the test fills.
std::deque<SpnavLibrary::Event> waiting;
bool has_daemon = true, endless = false;
int opened = 0, closed = 0;

SpnavLibrary fake_library() {
  SpnavLibrary library;
  library.open = [] { return has_daemon ? (++opened, 0) : -1; };
  library.close = [] { return ++closed, 0; };
  library.poll_event = [](SpnavLibrary::Event* event) {
    if (waiting.empty()) return 0;
    *event = waiting.front();
    if (!endless) waiting.pop_front();
    return event->type;
  };
  return library;
}

void moved(int x, int y, int z, int rx, int ry, int rz) { waiting.push_back({1, {x, y, z, rx, ry, rz}}); }
void button(int press, int number) { waiting.push_back({2, {press, number}}); }

}  // namespace

TEST_CASE("ignores a missing library or daemon of a 3D mouse silently") {
  SpaceMouse none(std::nullopt);
  CHECK_FALSE(none.there());
  CHECK(none.take(0).empty());
  has_daemon = false;
  closed = 0;
  {
    SpaceMouse mouse(fake_library());
    CHECK_FALSE(mouse.there());
    CHECK(mouse.take(0).empty());
  }
  CHECK(closed == 0);
  has_daemon = true;
}

TEST_CASE("moves and turns by the cap of a 3D mouse, with buttons as keys") {
  waiting.clear();
  opened = closed = 0;
  {
    SpaceMouse mouse(fake_library());
    CHECK(mouse.there());
    CHECK(opened == 1);
    CHECK(mouse.take(0).empty());
    moved(350, 0, -350, 0, 0, 0);
    std::vector<WindowEvent> events = mouse.take(2);
    REQUIRE(events.size() == 1);
    CHECK(events[0].kind == Kind::axes);
    CHECK(events[0].device == AxisDevice::space_mouse);
    CHECK(events[0].time == 2);
    CHECK(events[0].move == glm::vec3(1, 0, -1));
    CHECK(events[0].turn == glm::vec2(0));
    // Of simultaneous movements the last one counts. A button between them keeps its order.
    moved(10, 350, 0, 0, 0, 0);
    moved(10, 9999, 0, -700, 350, 0);
    button(1, 1);
    button(0, 1);
    button(1, 7);
    moved(0, 0, 0, 0, 0, 0);
    events = mouse.take(3);
    REQUIRE(events.size() == 4);
    CHECK(events[0].move == glm::vec3(0, 1, 0));  // 10 of 350 is noise of a resting hand
    CHECK(events[0].turn == glm::vec2(-1, -1));
    CHECK(events[1].kind == Kind::key_down);
    CHECK(events[1].key == letter_key('F'));
    CHECK(events[2].kind == Kind::key_up);
    CHECK(events[3].move == glm::vec3(0));
    endless = true;
    moved(1, 2, 3, 4, 5, 6);
    CHECK(mouse.take(4).size() == 1);  // the movement ends
    endless = false;
  }
  CHECK(closed == 1);
}

}  // namespace gs::app::space_mouse_test
