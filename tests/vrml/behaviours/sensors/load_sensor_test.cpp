#include "vrml/events/execution.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <vector>

using namespace gs;
using namespace gs::vrml;

namespace {

// World with a LoadSensor L, and a trace of the sensor's events.
struct LoadWorld {
  SceneGraph scene{"world.x3dv"};
  std::unique_ptr<Execution> execution;
  std::string trace;

  explicit LoadWorld(const std::string& body) {
    Diagnostics diagnostics;
    (void)parse("#X3D V3.3 utf8\nPROFILE Immersive\n" + body, scene, diagnostics);
    for (const Diagnostic& diagnostic : diagnostics.entries()) UNSCOPED_INFO(diagnostic.text());
    CHECK(diagnostics.entries().empty());
    execution = std::make_unique<Execution>(scene);
    execution->cascade().observe([this](const SentEvent& event) {
      if (scene.node(event.node).name != "L") return;
      trace += event.event->name + '=';
      print_value(trace, *event.value, *event.scene);
      trace += ' ';
    });
    execution->start(1000);
  }
  void note(std::size_t root, UrlLoad state) { execution->loads().note(scene.node(scene.roots()[root]), state); }
  std::string take_at(double time) {
    execution->step(1000 + time);
    return std::exchange(trace, {});
  }
};

}  // namespace

TEST_CASE("reports the loading of the watched nodes of a LoadSensor") {
  LoadWorld world(
      "DEF A Inline { url \"a\" } DEF B Inline { url \"b\" }\n"
      "DEF L LoadSensor { watchList [ USE A USE B ] }");
  CHECK(world.take_at(1) == "isActive=TRUE ");
  CHECK(world.take_at(2).empty());
  world.note(0, UrlLoad::loaded);
  CHECK(world.take_at(3) == "progress=0.5 ");
  world.note(1, UrlLoad::loaded);
  CHECK(world.take_at(4) == "progress=1 isActive=FALSE isLoaded=TRUE loadTime=1004 ");
  CHECK(world.take_at(5).empty());
  world.note(1, UrlLoad::pending);
  CHECK(world.take_at(6) == "isActive=TRUE progress=0.5 ");
  world.note(1, UrlLoad::failed);
  CHECK(world.take_at(7) == "progress=0.5 isActive=FALSE isLoaded=FALSE ");
}

TEST_CASE("reports watched nodes of a LoadSensor that were loaded before, and failures at the end of loading") {
  LoadWorld world(
      "DEF A Inline { url \"a\" } DEF E Inline { } DEF N Inline { load FALSE url \"n\" }\n"
      "DEF L LoadSensor { children [ USE A USE E USE N ] }");
  world.note(0, UrlLoad::loaded);
  CHECK(world.take_at(1) == "progress=1 isLoaded=TRUE loadTime=1001 ");
  LoadWorld failing("DEF A Inline { url \"a\" } DEF L LoadSensor { watchList USE A }");
  CHECK(failing.take_at(1) == "isActive=TRUE ");
  failing.execution->loads().end();
  CHECK(failing.take_at(2) == "progress=0 isActive=FALSE isLoaded=FALSE ");
}

TEST_CASE("ends the loading of a LoadSensor after its timeOut") {
  LoadWorld world("DEF A Inline { url \"a\" } DEF L LoadSensor { timeOut 5 watchList USE A }");
  CHECK(world.take_at(1) == "isActive=TRUE ");
  CHECK(world.take_at(3).empty());
  CHECK(world.take_at(6.5) == "isActive=FALSE isLoaded=FALSE ");
  CHECK(world.take_at(8).empty());
  world.note(0, UrlLoad::loaded);
  CHECK(world.take_at(9) == "progress=1 isLoaded=TRUE loadTime=1009 ");
}

TEST_CASE("sends nothing from a LoadSensor that is not enabled") {
  LoadWorld world("DEF A Inline { url \"a\" } DEF L LoadSensor { enabled FALSE watchList USE A }");
  CHECK(world.take_at(1).empty());
  const NodeId sensor = world.scene.roots()[1];
  REQUIRE(world.execution->send(world.scene, sensor, *world.scene.node(sensor).type->find("enabled"), SFBool{true}));
  CHECK(world.take_at(2).find("isActive=TRUE") != std::string::npos);
}
