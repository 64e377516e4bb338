#include "tests/vrml/events/trace.h"

#include "vrml/behaviours/browser_events.h"

// Tests of pauses of time-dependent nodes (X3D 8.2.4).
namespace gs::vrml::traces {

TEST_CASE("pauses a TimeSensor at pauseTime and continues its cycle at resumeTime (X3D 8.2.4)") {
  X3DWorld world("DEF T TimeSensor { startTime 1001 cycleInterval 10 }");
  world.start();
  world.step(1);
  world.step(2);
  (void)world.take();
  world.send_at(3, "T.pauseTime", SFTime{1003});
  CHECK(world.take("isPaused") == Lines{"3 T.isPaused TRUE"});
  CHECK(world.take_at(5).empty());
  CHECK_FALSE(world.execution().next_time());
  world.send_at(6, "T.resumeTime", SFTime{1007});
  (void)world.take();
  CHECK(world.execution().next_time() == World::kStart + 7);
  const Lines resumed = world.take_at(8);
  CHECK(resumed == Lines{"8 T.isPaused FALSE", "8 T.fraction_changed 0.3", "8 T.time 1008", "8 T.elapsedTime 3"});
  CHECK(world.take_at(15, "isActive") == Lines{"15 T.isActive FALSE"});
}

TEST_CASE("sends elapsedTime since the activation of a TimeSensor that loops (X3D 8.2.4)") {
  X3DWorld world("DEF T TimeSensor { loop TRUE cycleInterval 4 }");
  world.start();
  CHECK(world.take("elapsedTime") == Lines{"0 T.elapsedTime 0"});
  CHECK(world.take_at(2.5, "elapsedTime") == Lines{"2.5 T.elapsedTime 2.5"});
}

TEST_CASE("stops a paused TimeSensor at stopTime, and sends isPaused FALSE (X3D 8.2.4)") {
  X3DWorld world("DEF T TimeSensor { loop TRUE startTime 1001 pauseTime 1002 stopTime 1005 }");
  world.start();
  world.step(1);
  world.step(2);
  (void)world.take();
  CHECK(world.take_at(3).empty());
  CHECK(world.execution().next_time() == World::kStart + 5);
  CHECK(world.take_at(5) == Lines{"5 T.isPaused FALSE", "5 T.isActive FALSE"});
}

TEST_CASE("ignores a pauseTime before startTime or resumeTime (X3D 8.2.4)") {
  X3DWorld world(
      "DEF T TimeSensor { startTime 1001 pauseTime 900 cycleInterval 5 } "
      "DEF U TimeSensor { startTime 1001 pauseTime 1002 resumeTime 1003 cycleInterval 5 }");
  world.start();
  for (int i = 1; i < 5; ++i) world.step(i);
  CHECK(world.take("isPaused").empty());
}

TEST_CASE("holds the position of an AudioClip while it is paused (X3D 8.2.4)") {
  X3DWorld world("DEF A AudioClip { url \"a.wav\" startTime 1001 }");
  world.start();
  CHECK(report_media(world.execution(), world.scene(), world.node("A"), 10));
  world.step(1);
  world.send_at(3, "A.pauseTime", SFTime{1003});
  CHECK(world.take("isPaused") == Lines{"3 A.isPaused TRUE"});
  world.step(6);
  const auto paused = media_play(world.execution(), world.scene(), world.node("A"));
  REQUIRE(paused);
  CHECK_FALSE(paused->active);
  CHECK(paused->position == 2);
  world.send_at(7, "A.resumeTime", SFTime{1007});
  CHECK(world.take("isPaused") == Lines{"7 A.isPaused FALSE"});
  world.step(8);
  CHECK(media_play(world.execution(), world.scene(), world.node("A"))->position == 3);
  CHECK(world.take_at(15, "isActive") == Lines{"15 A.isActive FALSE"});
}

TEST_CASE("stops an AudioClip that is disabled, and does not start it (X3D 16.4.1)") {
  X3DWorld world(
      "DEF A AudioClip { url \"a.wav\" startTime 1001 } DEF Off AudioClip { url \"a.wav\" loop TRUE enabled FALSE }");
  world.start();
  CHECK(report_media(world.execution(), world.scene(), world.node("A"), 10));
  world.step(1);
  CHECK(world.take("isActive") == Lines{"1 A.isActive TRUE"});
  world.send_at(3, "A.enabled", SFBool{false});
  CHECK(world.take("isActive") == Lines{"3 A.isActive FALSE"});
  CHECK(world.take_at(5).empty());
}

}  // namespace gs::vrml::traces
