// Tests of the keys that worlds receive through KeySensor and StringSensor (X3D clause 21).
#include "app/session/navigation/key_input.h"

#include "tests/app/one_world.h"

#include <catch2/catch.hpp>

namespace gs::app::key_input_test {

using namespace sessions;

namespace {

WindowEvent special(Kind kind, Key key) {
  WindowEvent event;
  event.kind = kind;
  event.key = key;
  return event;
}

WindowEvent character(char32_t code_point) {
  WindowEvent event;
  event.kind = Kind::character;
  event.code = static_cast<int>(code_point);
  return event;
}

}  // namespace

TEST_CASE("sends keys to the KeySensor of a world, and moves no camera by them (X3D 21.4.1)") {
  OneWorld world("NavigationInfo { type \"FLY\" } Viewpoint { } DEF K KeySensor { }");
  world.watch();
  world.frame = world.session.step(kStart + 0.1, input_of({key(Kind::key_down, 'W'), character(U'w')}));
  world.frame = world.session.step(kStart + 0.6, input_of({}));
  CHECK(world.events == std::vector<std::string>{"isActive", "keyPress"});
  CHECK(world.place() == glm::vec3(0, 0, 10));
  world.events.clear();
  world.frame = world.session.step(kStart + 0.7, input_of({key(Kind::key_up, 'W')}));
  CHECK(world.events == std::vector<std::string>{"isActive", "keyRelease"});
  world.events.clear();
  world.frame = world.session.step(kStart + 0.8, input_of({special(Kind::key_down, Key::up)}));
  CHECK(world.events == std::vector<std::string>{"isActive", "actionKeyPress"});
}

TEST_CASE("moves the camera by keys if no sensor of keys is enabled") {
  OneWorld world("NavigationInfo { type \"FLY\" } Viewpoint { } DEF K KeySensor { enabled FALSE }");
  world.frame = world.session.step(kStart + 0.1, input_of({key(Kind::key_down, 'W')}));
  world.frame = world.session.step(kStart + 0.6, input_of({}));
  CHECK(world.place() != glm::vec3(0, 0, 10));
}

TEST_CASE("leaves Esc, Tab, function keys, and keys with Ctrl or Alt to the interface") {
  OneWorld world("DEF K KeySensor { }");
  const View& view = *world.session.view();
  for (const Key key : {Key::escape, Key::tab, Key::f1, Key::f12})
    CHECK_FALSE(world_takes_key(view, special(Kind::key_down, key)));
  WindowEvent with_control = key(Kind::key_down, 'O');
  CHECK(world_takes_key(view, with_control));
  with_control.control = true;
  CHECK_FALSE(world_takes_key(view, with_control));
  CHECK(world_takes_key(view, special(Kind::key_down, Key::enter)));
}

TEST_CASE("releases the keys of a KeySensor when the window loses the keyboard") {
  OneWorld world("DEF K KeySensor { }");
  world.watch();
  world.frame = world.session.step(kStart + 0.1, input_of({special(Kind::key_down, Key::shift)}));
  world.frame = world.session.step(kStart + 0.2, input_of({special(Kind::focus_lost, Key::unknown)}));
  CHECK(world.events == std::vector<std::string>{"isActive", "shiftKey", "isActive", "shiftKey"});
}

}  // namespace gs::app::key_input_test
