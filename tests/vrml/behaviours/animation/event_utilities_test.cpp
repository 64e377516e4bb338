#include "tests/vrml/events/trace.h"

// Tests of the component EventUtilities (X3D clause 30).
namespace gs::vrml::traces {

TEST_CASE("sends inputTrue or inputFalse, and inputNegate, from a BooleanFilter (X3D 30.4.1)") {
  X3DWorld world("DEF F BooleanFilter { }");
  world.start();
  world.send_at(1, "F.set_boolean", SFBool{true});
  CHECK(world.take() == Lines{"1 F.inputTrue TRUE", "1 F.inputNegate FALSE"});
  world.send_at(2, "F.set_boolean", SFBool{false});
  CHECK(world.take() == Lines{"2 F.inputFalse FALSE", "2 F.inputNegate TRUE"});
}

TEST_CASE("negates toggle of a BooleanToggle for TRUE, and ignores FALSE (X3D 30.4.3)") {
  X3DWorld world("DEF B BooleanToggle { toggle TRUE }");
  world.start();
  world.send_at(1, "B.set_boolean", SFBool{true});
  CHECK(world.take() == Lines{"1 B.toggle FALSE"});
  world.send_at(2, "B.set_boolean", SFBool{false});
  CHECK(world.take().empty());
  world.send_at(3, "B.set_boolean", SFBool{true});
  CHECK(world.take() == Lines{"3 B.toggle TRUE"});
  world.send_at(4, "B.toggle", SFBool{false});
  CHECK(world.take() == Lines{"4 B.toggle FALSE"});
}

TEST_CASE("converts events in BooleanTrigger, IntegerTrigger and TimeTrigger (X3D 30.4.4, 30.4.6, 30.4.7)") {
  X3DWorld world("DEF B BooleanTrigger { } DEF I IntegerTrigger { integerKey 7 } DEF T TimeTrigger { }");
  world.start();
  world.send_at(1, "B.set_triggerTime", SFTime{5});
  CHECK(world.take() == Lines{"1 B.triggerTrue TRUE"});
  world.send_at(2, "I.set_boolean", SFBool{false});
  CHECK(world.take() == Lines{"2 I.triggerValue 7"});
  world.send_at(3, "T.set_boolean", SFBool{false});
  CHECK(world.take() == Lines{"3 T.triggerTime 1003"});
}

TEST_CASE("selects the value of an IntegerSequencer by fraction, next and previous (X3D 30.3.1)") {
  X3DWorld world("DEF S IntegerSequencer { key [ 0 0.5 1 ] keyValue [ 10 20 30 ] }");
  world.start();
  const auto value = [&](double at, const char* event, auto given) {
    world.send_at(at, std::string("S.") + event, given);
    const Lines lines = world.take();
    return lines.empty() ? std::string() : lines[0].substr(lines[0].rfind(' ') + 1);
  };
  CHECK(value(1, "set_fraction", SFFloat{-1}) == "10");
  CHECK(value(2, "set_fraction", SFFloat{0.49F}) == "10");
  CHECK(value(3, "set_fraction", SFFloat{0.5F}) == "20");
  CHECK(value(4, "set_fraction", SFFloat{2}) == "30");
  CHECK(value(5, "next", SFBool{true}) == "10");
  CHECK(value(6, "next", SFBool{false}).empty());
  CHECK(value(7, "next", SFBool{true}) == "20");
  CHECK(value(8, "previous", SFBool{true}) == "10");
  CHECK(value(9, "previous", SFBool{true}) == "30");
}

TEST_CASE("begins with the first value of a sequencer on next, and with the last one on previous (X3D 30.3.1)") {
  X3DWorld world(
      "DEF S IntegerSequencer { key [ 0 1 ] keyValue [ 1 2 ] } DEF P IntegerSequencer { key [ 0 1 ] keyValue [ 1 2 ] } "
      "DEF Empty IntegerSequencer { }");
  world.start();
  world.send_at(1, "S.next", SFBool{true});
  CHECK(world.take() == Lines{"1 S.value_changed 1"});
  world.send_at(2, "P.previous", SFBool{true});
  CHECK(world.take() == Lines{"2 P.value_changed 2"});
  world.send_at(3, "Empty.next", SFBool{true});
  CHECK(world.take().empty());
}

}  // namespace gs::vrml::traces
