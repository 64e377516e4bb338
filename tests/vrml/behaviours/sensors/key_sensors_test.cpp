#include "tests/vrml/events/trace.h"

// Tests of KeySensor and StringSensor (X3D clause 21).
namespace gs::vrml::traces {
namespace {

using Kind = KeyStroke::Kind;

// Sends a key that types a character, as a window does: press, then character.
void type(World& world, double at, char32_t character) {
  world.step(at);
  world.execution().keys().send({Kind::press, static_cast<int>(character)});
  world.execution().keys().send({Kind::character, 0, 0, character});
}

void press(World& world, double at, const KeyStroke& stroke) {
  world.step(at);
  world.execution().keys().send(stroke);
}

// Returns the lines without their times, which differ in the last digits.
Lines events(World& world) {
  Lines lines = world.take();
  for (std::string& line : lines) line.erase(0, line.find(' ') + 1);
  return lines;
}

}  // namespace

TEST_CASE("sends characters, action keys and modifiers from a KeySensor (X3D 21.4.1)") {
  X3DWorld world("DEF K KeySensor { }");
  world.start();
  CHECK(world.execution().keys().is_sensed());
  type(world, 1, U'a');
  CHECK(events(world) == Lines{"K.isActive TRUE", "K.keyPress \"a\""});
  press(world, 2, {Kind::release, 'a'});
  CHECK(events(world) == Lines{"K.isActive FALSE", "K.keyRelease \"a\""});
  constexpr int kUp = 17;
  press(world, 3, {Kind::press, 265, kUp});
  CHECK(events(world) == Lines{"K.isActive TRUE", "K.actionKeyPress 17"});
  press(world, 4, {Kind::press, 340, 0, 0, ModifierKey::shift});
  CHECK(events(world) == Lines{"K.shiftKey TRUE"});
  press(world, 5, {Kind::release, 265});
  CHECK(events(world) == Lines{"K.actionKeyRelease 17"});
  press(world, 6, {Kind::release, 340});
  CHECK(events(world) == Lines{"K.isActive FALSE", "K.shiftKey FALSE"});
}

TEST_CASE("releases held keys of a KeySensor when the window loses the keyboard (X3D 21.4.1)") {
  X3DWorld world("DEF K KeySensor { }");
  world.start();
  press(world, 1, {Kind::press, 341, 0, 0, ModifierKey::control});
  (void)world.take();
  world.execution().keys().release_all();
  CHECK(events(world) == Lines{"K.isActive FALSE", "K.controlKey FALSE"});
}

TEST_CASE("collects text in a StringSensor until Enter (X3D 21.4.2)") {
  X3DWorld world("DEF S StringSensor { }");
  world.start();
  type(world, 1, U'h');
  CHECK(events(world) == Lines{"S.isActive TRUE", "S.enteredText \"h\""});
  type(world, 2, U'\u00e4');
  CHECK(events(world) == Lines{"S.enteredText \"h\u00e4\""});
  press(world, 3, {Kind::press, 259, 0, 8});
  CHECK(events(world) == Lines{"S.enteredText \"h\""});
  press(world, 4, {Kind::press, 257, 0, 10});
  CHECK(events(world) == Lines{"S.finalText \"h\"", "S.isActive FALSE"});
  type(world, 5, U'x');
  CHECK(events(world) == Lines{"S.isActive TRUE", "S.enteredText \"x\""});
  press(world, 6, {Kind::press, 256, 0, 27});
  CHECK(events(world) == Lines{"S.isActive FALSE"});
}

TEST_CASE("keeps the text of a StringSensor with deletionAllowed FALSE (X3D 21.4.2)") {
  X3DWorld world("DEF S StringSensor { deletionAllowed FALSE }");
  world.start();
  type(world, 1, U'a');
  (void)world.take();
  press(world, 2, {Kind::press, 259, 0, 8});
  CHECK(events(world).empty());
}

TEST_CASE("sends no keys to a disabled sensor (X3D 21.3.1)") {
  X3DWorld world("DEF K KeySensor { enabled FALSE } DEF S StringSensor { }");
  world.start();
  type(world, 1, U'a');
  CHECK(events(world) == Lines{"S.isActive TRUE", "S.enteredText \"a\""});
  world.send_at(2, "S.enabled", SFBool{false});
  CHECK(events(world) == Lines{"S.isActive FALSE", "S.enabled FALSE"});
  CHECK_FALSE(world.execution().keys().is_sensed());
  type(world, 3, U'b');
  CHECK(events(world).empty());
}

}  // namespace gs::vrml::traces
