#include "tests/vrml/events/trace.h"
#include "vrml/behaviours/browser_events.h"

#include <limits>

namespace gs::vrml::traces {

TEST_CASE("reports the progress of a QNV node, and its completion") {
  World world("Shape { geometry DEF N QNV { } } DEF T TimeSensor { } ROUTE N.loadTime TO T.startTime DEF B Box { }");
  world.start();
  const auto progress = [&](double fraction) {
    return report_progress(world.execution(), world.scene(), world.node("N"), fraction);
  };
  CHECK(progress(0));
  CHECK(world.take().empty());
  world.step(1);
  CHECK(progress(0.5));
  CHECK(progress(0.505));  // too small a change to be reported
  CHECK(world.take() == Lines{"1 N.progress_changed 0.5"});
  CHECK_FALSE(progress(0.75));  // not twice with one timestamp (4.10.4)
  CHECK(world.take().empty());
  world.step(2);
  CHECK(progress(0.75));
  CHECK(progress(std::numeric_limits<double>::quiet_NaN()));
  CHECK_FALSE(progress(1));
  CHECK(world.take() == Lines{"2 N.progress_changed 0.75"});
  world.step(3);
  CHECK(progress(7));
  CHECK(world.take("N.") == Lines{"3 N.progress_changed 1", "3 N.loadTime 1003"});
  CHECK(world.scene().get<SFTime>(world.node("T"), "startTime") == World::kStart + 3);
  CHECK(progress(1));
  // The progress falls and becomes complete again. The stream was complete before.
  world.step(4);
  CHECK(progress(0.9));
  world.step(5);
  CHECK(progress(1));
  CHECK(world.take("N.") == Lines{"4 N.progress_changed 0.9", "5 N.progress_changed 1"});
  // Another stream starts from the beginning.
  world.step(6);
  CHECK(progress(-1));
  world.step(7);
  CHECK(progress(0.995));
  world.step(8);
  CHECK(progress(1));
  CHECK(world.take("N.") ==
        Lines{"6 N.progress_changed 0", "7 N.progress_changed 0.995", "8 N.progress_changed 1", "8 N.loadTime 1008"});
  CHECK(report_progress(world.execution(), world.scene(), world.node("B"), 1));
  CHECK(report_progress(world.execution(), world.scene(), NodeId{}, 1));
  CHECK(world.take().empty());
}

TEST_CASE("reports the progress of a PROTO that replaces QNV in other browsers") {
  World world(R"(PROTO QNV [ field MFString url [ ] eventOut SFFloat progress_changed eventOut SFTime loadTime ]
      { Box { } }
    PROTO Odd [ eventOut SFVec3f progress_changed eventIn SFTime loadTime ] { Box { } }
    Shape { geometry DEF P QNV { } } Shape { geometry DEF O Odd { } })");
  world.start();
  CHECK(report_progress(world.execution(), world.scene(), world.node("P"), 1));
  CHECK(report_progress(world.execution(), world.scene(), world.node("O"), 1));
  CHECK(world.take() == Lines{"0 P.progress_changed 1", "0 P.loadTime 1000"});
}

}  // namespace gs::vrml::traces
