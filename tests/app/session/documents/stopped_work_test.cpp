// Tests of work for hostile worlds that the user stops.
#include "app/base/world_work.h"
#include "app/script/process/program_process.h"
#include "app/session/running/world_runtime.h"
#include "base/thread_time.h"
#include "tests/app/program.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace gs::app::stopped_work_test {
namespace {

/// Guard: the user asks to stop all work of this thread that takes long. Scripts run in children.
struct ImpatientUser {
  ImpatientUser() {
    script::set_program_of_scripts(program());
    set_stop_request([this] { return ++requests > 0; });
  }
  ~ImpatientUser() {
    set_stop_request({});
    script::set_program_of_scripts({});
  }
  int requests = 0;
};

std::string repeated(const std::string& text, int count) {
  std::string all;
  all.reserve(text.size() * static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

/// Longest time that a call for a world took, and the messages about it.
struct Played {
  double longest = 0;
  std::vector<std::string> messages;
};

Played play(const std::string& body) {
  LoadedWorld opened;
  Diagnostics diagnostics;
  opened.scene = std::make_unique<vrml::SceneGraph>("text.wrl");
  (void)vrml::parse("#VRML V2.0 utf8\n" + body, *opened.scene, diagnostics);
  for (const Diagnostic& one : diagnostics.entries()) UNSCOPED_INFO(one.text());
  CHECK(diagnostics.errors() == 0);
  opened.scene->budget()->stop_when(is_work_unwanted);
  render::MeshCache meshes;
  WorldRuntime runtime(opened, meshes);
  Played played;
  const auto timed = [&](const auto& call) {
    const double before = thread_seconds();
    call();
    played.longest = std::max(played.longest, thread_seconds() - before);
  };
  std::shared_ptr<RuntimeScene> seen;
  timed([&] { runtime.start(1000); });
  timed([&] { seen = runtime.look({0, 0, 10}, true); });
  for (int i = 1; i <= 4; ++i) {
    runtime.execution().viewer().set(glm::dmat4(1));
    timed([&] { (void)runtime.step(1000 + i / 4.0); });
    timed([&] { (void)runtime.show(*seen, {0, 0, 10.0 + i}); });
  }
  for (const ScriptMessage& message : runtime.programs().take_messages())
    played.messages.push_back(message.diagnostic.text());
  return played;
}

const std::string kClock = "DEF Clock TimeSensor { loop TRUE cycleInterval 1 }\n";

std::string script(const std::string& interface, const std::string& program) {
  return kClock + "DEF S Script { directOutput TRUE eventIn SFTime tick " + interface +
         " url \"javascript: " + program + "\" } ROUTE Clock.time TO S.tick\n";
}

std::vector<std::pair<std::string, std::string>> hostile_worlds() {
  std::vector<std::pair<std::string, std::string>> all;
  const auto add = [&](const std::string& name, const std::string& text) { all.emplace_back(name, text); };
  std::string chain = kClock;
  for (int i = 0; i < 4000; ++i) {
    const std::string n = std::to_string(i);
    chain += "DEF R" + n + " CoordinateInterpolator { key [ 0 1 ] keyValue [ " + repeated("0 0 0 ", 20) +
             "] } ROUTE Clock.fraction_changed TO R" + n + ".set_fraction\n DEF C" + n + " Coordinate { }\n";
    for (int j = 0; j < 30; ++j)
      chain += "ROUTE R" + n + ".value_changed TO C" +
               std::to_string(i * 7 % (i + 1) + j < i ? (i * 7 % (i + 1)) + j : 0) + ".set_point\n";
  }
  add("fan-out", chain);
  add("large string", script("field SFString text \"\"",
                             "function initialize() { text = 'Transform { children Group { } } '.repeat(100000); } "
                             "function tick() { Browser.createVrmlFromString(text); }"));
  add("instances",
      script("",
             "function tick() { var t = 'PROTO P0 [ ] { Group { } } '; for (var i = 1; i < 22; ++i) t += "
             "'PROTO P' + i + ' [ ] { Group { children [ P' + (i - 1) + ' { } P' + (i - 1) + ' { } ] } } '; "
             "Browser.createVrmlFromString(t + ' P20 { }'); }"));
  add("collection", script("field MFNode kept [ ] field SFInt32 count 0",
                           "function tick() { kept = new MFNode(); "
                           "Browser.createVrmlFromString('Transform { translation 1 2 3 } '.repeat(100000)); }"));
  add("chatty program", script("field SFNode clock USE Clock",
                               "function tick() { for (;;) Browser.getCurrentFrameRate(), clock.cycleInterval; }"));
  add("many slow programs",
      kClock +
          repeated("DEF S Script { eventIn SFTime tick url \"javascript: function wait() { for (var end = Date.now() "
                   "+ 60; Date.now() < end;) ; } function tick() { } function eventsProcessed() { wait(); }\" } "
                   "ROUTE Clock.time TO S.tick\n",
                   60));
  add("children", script("field SFNode group Group { } field MFNode made [ ]",
                         "function initialize() { made = Browser.createVrmlFromString('Group { } '.repeat(200000)); } "
                         "function tick() { for (var i = 0; i < 40; ++i) { group.addChildren = made; "
                         "group.removeChildren = made; } }"));
  std::string sensors = kClock;
  for (int i = 0; i < 30000; ++i) sensors += "ProximitySensor { size 1e5 1e5 1e5 } VisibilitySensor { size 9 9 9 } ";
  add("sensors", sensors);
  std::string polygon = "Shape { geometry IndexedFaceSet { convex FALSE coord Coordinate { point [ ", index = "";
  for (int i = 0; i < 60000; ++i) {
    polygon += std::to_string(i % 2 == 0 ? i : 1.0 / (i + 1)) + " " + std::to_string(i * 37 % 1009) + " 0 ";
    index += std::to_string(i) + " ";
  }
  add("polygon", polygon + "] } coordIndex [ " + index + "-1 ] } }");
  add("extrusion", "Shape { geometry Extrusion { creaseAngle 1 crossSection [ " + repeated("0 1, 1 0, 0 0.5, ", 700) +
                       " ] spine [ " + repeated("0 1 0, 1 0 1, 0 0 0.5, ", 1000) + " ] } }");
  add("text", "Shape { geometry Text { string \"" + repeated("Sphinx of black quartz ", 60000) + "\" } }");
  add("many texts",
      repeated("Shape { geometry Text { string \"" + repeated("Sphinx of black quartz ", 20) + "\" } } ", 4000));
  add("grid", "Shape { geometry ElevationGrid { creaseAngle 1 xDimension 1500 zDimension 1500 height [ " +
                  repeated("0 1 0.3 ", 750000) + " ] } }");
  std::string shapes = kClock;
  for (int i = 0; i < 100000; ++i) shapes += "Transform { translation 1 0 0 children Shape { geometry Sphere { } } } ";
  add("many shapes", shapes);
  return all;
}

}  // namespace

TEST_CASE("ends work for hostile worlds soon after the user's request", "[optimised]") {
  for (const auto& [name, text] : hostile_worlds()) {
    const ImpatientUser user;
    const Played played = play(text);
    if (std::getenv("GHOSTSPACE_PRINT_TIMES")) {
      std::fprintf(stderr, "%-20s %.2f s, %d requests\n", name.c_str(), played.longest, user.requests);
      for (const std::string& message : played.messages) std::fprintf(stderr, "    %s\n", message.c_str());
    }
    INFO(name);
    CHECK(played.longest < 3);  // processor seconds; with these checks on a busy machine, 0.6 were seen
  }
}

TEST_CASE("stops the events of a world at the user's request, with one message") {
  for (const auto& [name, text] : hostile_worlds()) {
    if (name != "instances" && name != "grid") continue;
    const ImpatientUser user;
    const Played played = play(text);
    INFO(name);
    CHECK(std::count_if(played.messages.begin(), played.messages.end(), [](const std::string& message) {
            return message.find("the events of this world took long and were stopped by the user") != std::string::npos;
          }) == (user.requests > 0 ? 1 : 0));
  }
}

TEST_CASE("gives the work for each world its full time after a stop") {
  const ImpatientUser user;
  const auto from = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count(); };
  const WorldWork all;
  {
    const WorldWork one;
    while (!is_work_unwanted() && seconds() < 10) std::this_thread::yield();
    CHECK(seconds() >= 0.5);
    CHECK(one.was_stopped());
  }
  const WorldWork other;
  CHECK(!is_work_unwanted());
  CHECK(!other.was_stopped());
  bool elsewhere = true;
  std::thread([&] { elsewhere = is_work_unwanted(); }).join();
  CHECK(!elsewhere);
}

}  // namespace gs::app::stopped_work_test
