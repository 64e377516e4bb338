#include "tests/vrml/events/trace.h"
#include "vrml/behaviours/browser_events.h"

#include <cmath>
#include <optional>
#include <string>

namespace gs::vrml::traces {
namespace media_clock_test {

// World::kStart is 1000. Traces have times since then, SFTime values are absolute.

MediaPlay play_of(World& world, std::string_view name) {
  const std::optional<MediaPlay> play = media_play(world.execution(), world.scene(), world.node(name));
  REQUIRE(play);
  return *play;
}

bool came(World& world, std::string_view name, double seconds) {
  return report_media(world.execution(), world.scene(), world.node(name), seconds);
}

const std::string kClip = "Sound { source DEF C AudioClip { url \"a.wav\" ";
const std::string kMovie = "Shape { appearance Appearance { texture DEF M MovieTexture { url \"a.mpg\" ";

TEST_CASE("sends duration_changed when the sound is loaded, and -1 if loading fails (6.4, 6.28)") {
  World world(kClip + "} } " + kMovie + "} } }");
  world.start();
  CHECK(world.take().empty());
  CHECK(came(world, "C", 2.5));
  CHECK(world.take() == Lines{"0 C.duration_changed 2.5"});
  CHECK_FALSE(came(world, "C", 3));  // once per timestamp
  world.step(1);
  CHECK(came(world, "C", 3));
  CHECK(came(world, "M", -1));
  CHECK(world.take() == Lines{"1 C.duration_changed 3", "1 M.duration_changed -1"});
  world.step(2);
  CHECK(came(world, "M", std::nan("")));
  CHECK(world.take() == Lines{"2 M.duration_changed -1"});
}

TEST_CASE("keeps an AudioClip active for one cycle, its duration divided by pitch (6.4)") {
  World world(kClip + "startTime 1001 pitch 2 } }");
  world.start();
  (void)came(world, "C", 3);
  (void)world.take();
  world.step(0.5);
  CHECK_FALSE(play_of(world, "C").active);
  CHECK(world.take_at(1) == Lines{"1 C.isActive TRUE"});
  world.step(2);
  CHECK(play_of(world, "C").position == Approx(2));  // t = (now - startTime) modulo duration/pitch, at twice the speed
  CHECK(play_of(world, "C").end == 1002.5);
  CHECK(world.take_at(2.49).empty());
  CHECK(world.take_at(2.5) == Lines{"2.5 C.isActive FALSE"});
  CHECK(play_of(world, "C").position == 3);
}

TEST_CASE("plays a looping AudioClip in world time, and ends it at stopTime (4.6.9, 6.4)") {
  World world(kClip + "startTime 400 stopTime 1004 loop TRUE } }");
  world.start();
  CHECK(world.take() == Lines{"0 C.isActive TRUE"});
  (void)came(world, "C", 7);
  (void)world.take();
  world.step(1);
  CHECK(play_of(world, "C").position == Approx(std::fmod(601, 7)));
  CHECK(world.take_at(3.9).empty());
  CHECK(world.take_at(4.5) == Lines{"4.5 C.isActive FALSE"});
  CHECK(play_of(world, "C").position == Approx(std::fmod(604, 7)));  // at stopTime, not at the step
}

TEST_CASE("plays no AudioClip with default fields, and none that ended before the world began (4.6.9)") {
  World world("Sound { source DEF C AudioClip { } } " + kMovie + "startTime 990 } } }");
  world.start();
  CHECK(came(world, "M", 5));
  CHECK(world.take_at(1) == Lines{"0 M.duration_changed 5"});
  World within(kMovie + "startTime 990 } } }");
  within.start();
  CHECK(came(within, "M", 15));
  CHECK(within.take() == Lines{"0 M.duration_changed 15", "0 M.isActive TRUE"});
  CHECK(within.take_at(5) == Lines{"5 M.isActive FALSE"});
}

TEST_CASE("starts a clip that loads late at the position that it would have reached (6.4)") {
  World world(kClip + "} } Sound { source DEF D AudioClip { url \"b.wav\" } } Sound { source DEF E AudioClip { } }");
  world.start();
  world.step(1);
  for (const char* target : {"C.startTime", "D.startTime", "E.startTime"}) world.send(target, SFTime{1001});
  CHECK(world.take("isActive") == Lines{"1 C.isActive TRUE", "1 D.isActive TRUE"});  // E is never loaded
  world.step(3);
  CHECK(came(world, "C", 4));
  CHECK(came(world, "D", -1));
  CHECK(world.take() == Lines{"3 C.duration_changed 4", "3 D.duration_changed -1", "3 D.isActive FALSE"});
  CHECK(play_of(world, "C").position == Approx(2));
  CHECK(world.take_at(6) == Lines{"6 C.isActive FALSE"});
}

TEST_CASE("ignores set_pitch, set_speed, set_startTime and an early set_stopTime while active (4.6.9, 6.4, 6.28)") {
  World world(kClip + "loop TRUE } } " + kMovie + "loop TRUE } } }");
  world.start();
  (void)world.take();
  world.send_at(1, "C.pitch", SFFloat{2});
  world.send("M.speed", SFFloat{2});
  for (const std::string name : {"C", "M"}) {
    world.send(name + ".startTime", SFTime{1005});
    world.send(name + ".stopTime", SFTime{-1});
  }
  CHECK(world.take().empty());
  CHECK(play_of(world, "C").rate == 1);
  CHECK(play_of(world, "M").rate == 1);
  CHECK(play_of(world, "C").start == 0);
  world.send_at(2, "C.stopTime", SFTime{1002});  // the present time, so the clip ends
  world.send("M.loop", SFBool{true});
  CHECK(world.take() == Lines{"2 C.stopTime 1002", "2 C.isActive FALSE", "2 M.loop TRUE"});
  world.send("C.pitch", SFFloat{2});
  CHECK(world.take() == Lines{"2 C.pitch 2"});
}

TEST_CASE("ends a clip after its current cycle on set_loop FALSE (4.6.9)") {
  World world(kClip + "startTime 1000 loop TRUE } }");
  world.start();
  (void)came(world, "C", 2);
  (void)world.take();
  world.send_at(5, "C.loop", SFBool{false});
  CHECK(world.take_at(5.9) == Lines{"5 C.loop FALSE"});
  CHECK(world.take_at(6) == Lines{"6 C.isActive FALSE"});
}

TEST_CASE("restarts a clip if stopTime and startTime are set at one time (4.6.9)") {
  World world(kClip + "startTime 1000 loop TRUE } }");
  world.start();
  (void)came(world, "C", 2);
  world.step(3);
  (void)world.take();
  world.send("C.startTime", SFTime{1003});
  world.send("C.stopTime", SFTime{1003});
  CHECK(world.take() == Lines{"3 C.stopTime 1003", "3 C.isActive FALSE", "3 C.startTime 1003"});
  CHECK(world.take_at(3.5) == Lines{"3.5 C.isActive TRUE"});
  CHECK(play_of(world, "C").position == Approx(0.5));
}

TEST_CASE("plays a MovieTexture backwards at negative speed, and freezes it at speed 0 (6.28)") {
  World world(kMovie +
              "speed -2 startTime 1001 } } } Shape { appearance Appearance { texture DEF Z MovieTexture { "
              "url \"b.mpg\" speed 0 startTime 1001 } } }");
  world.start();
  (void)came(world, "M", 5);
  (void)came(world, "Z", 5);
  CHECK(play_of(world, "M").position == 5);  // the last frame, before it was first active
  CHECK(play_of(world, "Z").position == 0);
  world.step(1);
  (void)world.take();
  world.step(2);
  CHECK(play_of(world, "M").position == Approx(3));  // t = duration - ((now - startTime) modulo abs(duration/speed))
  CHECK(play_of(world, "Z").position == 0);
  CHECK(world.take_at(3.5) == Lines{"3.5 M.isActive FALSE"});
  CHECK(play_of(world, "M").position == 0);
  world.step(100);
  CHECK(play_of(world, "Z").active);  // its cycle never ends
}

TEST_CASE("keeps the movie frame of the time at which the movie became inactive (6.28)") {
  World world(kMovie + "startTime 1000 stopTime 1002.25 loop TRUE } } }");
  world.start();
  (void)came(world, "M", 1.5);
  world.step(2);
  world.step(4);
  CHECK_FALSE(play_of(world, "M").active);
  CHECK(play_of(world, "M").position == Approx(0.75));
  world.step(9);
  CHECK(play_of(world, "M").position == Approx(0.75));
  // A stopTime in the past means the present.
  World other(kMovie + "startTime 1000 loop TRUE } } }");
  other.start();
  (void)came(other, "M", 4);
  other.send_at(3, "M.stopTime", SFTime{1001});
  CHECK_FALSE(play_of(other, "M").active);
  CHECK(play_of(other, "M").position == Approx(3));
}

TEST_CASE("replaces invalid fields of an AudioClip by defaults, and plays nothing before it is loaded (6.4)") {
  World world(kClip + "pitch -1 startTime 1000 } } Sound { source DEF D AudioClip { url \"b.wav\" startTime 1000 } }");
  world.start();
  (void)came(world, "C", 2);
  (void)came(world, "D", 0);
  CHECK(play_of(world, "C").rate == 1);
  CHECK(play_of(world, "C").end == 1002);
  CHECK_FALSE(play_of(world, "D").active);
  CHECK_FALSE(media_play(world.execution(), world.scene(), {}));
}

}  // namespace media_clock_test
}  // namespace gs::vrml::traces
