#include "vrml/events/execution.h"

#include "tests/vrml/events/trace.h"

#include <string>

namespace gs::vrml::traces {

TEST_CASE("delivers a hundred thousand cyclic ROUTEs in one cascade") {
  std::string text = "DEF A Switch { } DEF B Switch { }";
  constexpr int kTargets = 1000;
  for (int i = 0; i < kTargets; ++i) text += " DEF S" + std::to_string(i) + " Switch { }";
  for (int i = 0; i < kTargets; ++i) text += " ROUTE A.whichChoice TO S" + std::to_string(i) + ".whichChoice";
  for (int i = 0; i < kTargets; ++i)
    for (int k = 0; k < kTargets; k += 10)
      text += " ROUTE S" + std::to_string(i) + ".whichChoice TO S" + std::to_string(k) + ".whichChoice";
  World world(text);
  world.start();
  world.send("A.whichChoice", SFInt32{7});
  CHECK(world.take().size() == kTargets + 1);
  CHECK(world.execution().budget().problem().empty());
}

TEST_CASE("limits fan-in times fan-out of PROTO instances") {
  std::string inner = "PROTO P [ eventIn SFInt32 in ] { Group { children [";
  for (int i = 0; i < 5000; ++i) inner += " Switch { set_whichChoice IS in }";
  std::string text = inner + " ] } } DEF I P { } DEF A Switch { }";
  for (int i = 0; i < 5000; ++i)
    text += " DEF S" + std::to_string(i) + " Switch { } ROUTE A.whichChoice TO S" + std::to_string(i) +
            ".whichChoice ROUTE S" + std::to_string(i) + ".whichChoice TO I.in";
  World world(text);
  world.start();
  world.send("A.whichChoice", SFInt32{7});
  CHECK(!world.execution().budget().problem().empty());
  world.step(1);  // the next timestamp is a new one
  world.send("A.whichChoice", SFInt32{8});
  CHECK(world.scene().get<SFInt32>(world.node("S4999"), "whichChoice") == 8);
}

TEST_CASE("sends events through PROTO instances of any nesting depth") {
  std::string text = "PROTO P0 [ exposedField SFInt32 x 0 ] { DEF Core Switch { whichChoice IS x } }";
  constexpr int kDepth = 5000;
  for (int i = 1; i <= kDepth; ++i)
    text +=
        "\nPROTO P" + std::to_string(i) + " [ exposedField SFInt32 x 0 ] { P" + std::to_string(i - 1) + " { x IS x } }";
  World world(text + "\nDEF I P" + std::to_string(kDepth) + " { } DEF A Switch { } ROUTE A.whichChoice TO I.x");
  world.start();
  world.send("A.whichChoice", SFInt32{7});
  CHECK(world.take().size() == kDepth + 3);
  CHECK(world.scene().get<SFInt32>(world.node("I"), "x") == 7);
}

TEST_CASE("leaves out ROUTEs beyond the budget and reports it") {
  Limits limits;
  limits.memory = std::size_t{16} << 20;
  std::string text;
  for (int i = 0; i < 15'000; ++i) text += "DEF S" + std::to_string(i) + " Switch { }\n";
  for (int i = 1; i < 15'000; ++i) text += "ROUTE S0.whichChoice TO S" + std::to_string(i) + ".whichChoice\n";
  SceneGraph scene("text.wrl", limits);
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\n" + text, scene, diagnostics);
  Execution execution(scene);
  CHECK(execution.budget().problem().find("--memory") != std::string::npos);
  execution.start(0);
  execution.step(1);
}

TEST_CASE("stops time-dependent nodes that trigger each other within one timestamp") {
  World world(R"(
DEF A TimeSensor { cycleInterval 0.001 } DEF B TimeSensor { cycleInterval 0.001 }
ROUTE A.time TO B.startTime ROUTE B.time TO A.startTime ROUTE A.cycleTime TO A.startTime ROUTE B.time TO B.startTime)");
  world.start();
  world.send("A.startTime", SFTime{World::kStart});
  for (int i = 1; i < 100; ++i) CHECK(world.take_at(i / 60.0).size() < 100 * 12);
}

}  // namespace gs::vrml::traces
