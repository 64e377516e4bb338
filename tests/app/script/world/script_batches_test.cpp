// Tests of calls of programs that travel together: without an observer, they must have the effects of single calls.
#include "app/script/process/program_process.h"
#include "tests/app/program.h"
#include "tests/app/script/scripts.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <string>

namespace gs::app::script_batches_test {
namespace {

// With an observer, each call is made alone.
enum class Calls { single, together };

std::string scene_text(scripts::World& world) {
  std::string text;
  for (std::uint32_t i = 1; i <= world.scene().nodes().count(); ++i) {
    const vrml::NodeId id = world.scene().nodes().id_at(i);
    if (!world.scene().contains(id)) continue;
    const vrml::Node& node = world.scene().node(id);
    for (std::size_t slot = 0; slot < node.type->defaults.size(); ++slot) {
      vrml::print_value(text, node.values[slot], world.scene());
      text += '\n';
    }
  }
  return text;
}

/// Returns everything that programs print and report in some steps, and the scene at the end.
scripts::Lines result_of(const std::string& body, Calls calls, double seconds = 1) {
  Limits limits;
  limits.script_seconds = seconds;
  scripts::World world(body, limits);
  if (calls == Calls::together) world.execution().cascade().observe({});
  world.start();
  for (int i = 1; i <= 4; ++i) world.step(i / 8.0);
  scripts::Lines lines = world.printed();
  for (const std::string& line : world.problems()) lines.push_back(line);
  lines.push_back(scene_text(world));
  return lines;
}

std::string script(const std::string& name, const std::string& interface, const std::string& program) {
  return "DEF " + name + " Script { directOutput TRUE eventIn SFFloat go eventIn SFFloat second " + interface +
         " url \"javascript: " + program + "\" }\n";
}

const std::string kClock = "DEF Clock TimeSensor { loop TRUE cycleInterval 1 }\n";

std::string route(const std::string& from, const std::string& to) { return "ROUTE " + from + " TO " + to + "\n"; }

// Scripts that each print their event and send one to a Transform. Each of them also has eventsProcessed().
std::string many(int count) {
  std::string text = kClock;
  for (int i = 0; i < count; ++i) {
    const std::string n = std::to_string(i);
    text +=
        script("S" + n, "eventOut SFVec3f moved field SFInt32 calls 0",
               "function go(value, time) { calls++; print('S" + n + " ' + value + ' ' + time); moved = new SFVec3f(" +
                   n + ", value, calls); } function eventsProcessed() { print('end " + n + " ' + moved); }");
    text += "DEF T" + n + " Transform {}\n" + route("Clock.fraction_changed", "S" + n + ".go") +
            route("S" + n + ".moved", "T" + n + ".translation");
  }
  return text;
}

/// Guard: Scripts run in children while it exists.
struct ChildrenOfBatches {
  ChildrenOfBatches() { script::set_program_of_scripts(program()); }
  ~ChildrenOfBatches() { script::set_program_of_scripts({}); }
};

// Worlds in which the order of calls and events matters.
std::vector<std::string> worlds() {
  std::vector<std::string> all;
  all.push_back(many(40));
  // A Script between Scripts, an event to itself, and a node that several programs read and write.
  all.push_back(
      kClock + "DEF D Transform {}\n" +
      script("A", "eventOut SFFloat out field SFNode d USE D",
             "function go(v) { print('A.go ' + d.translation); out = v; } function second(v) { print('A.second ' + v); "
             "out = v + 10; }") +
      script("B", "eventOut SFVec3f place field SFNode d USE D",
             "function go(v) { print('B.go ' + v + ' ' + d.translation); place = new SFVec3f(v, 1, 0); } "
             "function second(v) { print('B.second ' + v); d.translation = new SFVec3f(0, 0, v); }") +
      route("Clock.fraction_changed", "A.go") + route("A.out", "A.second") + route("A.out", "B.go") +
      route("Clock.fraction_changed", "B.second") + route("Clock.fraction_changed", "A.second") +
      route("B.place", "D.set_scale") + route("B.place", "D.translation") + route("A.out", "B.second"));
  // Programs that change ROUTEs, add Scripts and fail between others.
  all.push_back(
      kClock + script("Before", "", "function go(v) { print('before ' + v); }") +
      script("Router",
             "field SFNode clock USE Clock field SFNode other Script { eventIn SFFloat go url \"javascript: function "
             "go(v) { print('other ' + v); }\" }",
             "function go(v) { if (v > 0.2) Browser.deleteRoute(clock, 'fraction_changed', other, 'go'); else "
             "Browser.addRoute(clock, 'fraction_changed', other, 'go'); print('router ' + v); }") +
      script("Maker", "field SFNode made NULL",
             "function go(v) { if (made == null) made = Browser.createVrmlFromString('Script { url \\\"javascript: "
             "function initialize() { print(7); }\\\" }')[0]; print('maker ' + v); }") +
      script("Fails", "", "function go(v) { print('fails'); nothing.value = v; }") +
      script("After", "eventOut SFFloat out", "function go(v) { out = v; print('after ' + v); }") +
      script("Last", "", "function go(v) { print('last ' + v); } function second(v) { print('second ' + v); }") +
      route("Clock.fraction_changed", "Before.go") + route("Clock.fraction_changed", "Router.go") +
      route("Clock.fraction_changed", "Maker.go") + route("Clock.fraction_changed", "Fails.go") +
      route("Clock.fraction_changed", "After.go") + route("Clock.fraction_changed", "Last.go") +
      route("After.out", "Last.second"));
  // Scripts inside of PROTO instances, with fields that events set.
  all.push_back(
      "PROTO P [ eventIn SFFloat go eventOut SFFloat out field SFString name \"\" ] { Script { eventIn SFFloat go IS "
      "go "
      "eventOut SFFloat out IS out field SFString name IS name url \"javascript: function go(v) { print(name + v); out "
      "= v * 2; }\" } }\n" +
      kClock + "DEF A P { name \"a\" } DEF B P { name \"b\" } DEF C P { name \"c\" }\n" +
      route("Clock.fraction_changed", "A.go") + route("Clock.fraction_changed", "B.go") + route("A.out", "C.go") +
      route("B.out", "A.go"));
  return all;
}

}  // namespace

TEST_CASE("makes calls of programs together with the effects of single calls") {
  for (const std::string& world : worlds()) CHECK(result_of(world, Calls::together) == result_of(world, Calls::single));
}

TEST_CASE("sends calls of programs to a child together with the effects of single calls") {
  const ChildrenOfBatches children;
  for (const std::string& world : worlds()) CHECK(result_of(world, Calls::together) == result_of(world, Calls::single));
}

TEST_CASE("names the program that ends a child among calls that travel together") {
  const ChildrenOfBatches children;
  const std::string hangs = "function go(v) { +('0.' + '1'.repeat(1 << 23)); }";
  std::string text = kClock;
  for (const std::string name : {"A", "B", "C", "D"})
    text += script(name, "", name == "C" ? hangs : "function go(v) { print('" + name + "'); }") +
            route("Clock.fraction_changed", name + ".go");
  const scripts::Lines lines = result_of(text, Calls::together, 0.1);
  REQUIRE(lines.size() == 2);
  CHECK(lines.front().find("Script C: the program exceeded the time limit and cannot be interrupted; all programs of "
                           "this world end") != std::string::npos);
}

TEST_CASE("limits each of the calls that travel together, and keeps events for the next step") {
  const ChildrenOfBatches children;
  std::string text = "DEF N ScalarInterpolator { key 0 keyValue 0 }\n";
  for (int i = 0; i < 6; ++i) {
    const std::string n = std::to_string(i);
    text += script("S" + n, "",
                   "function go(v) { print(" + n + "); for (var end = Date.now() + 40; Date.now() < end;) ; }") +
            route("N.value_changed", "S" + n + ".go");
  }
  scripts::World world(text, {}, {0.1, false});
  world.execution().cascade().observe({});
  world.start();
  world.send_at(0.1, "N.set_fraction", vrml::SFFloat(0));
  scripts::Lines all = world.printed();
  CHECK((all.size() >= 1 && all.size() <= 4));
  for (int i = 2; i <= 8; ++i) {
    world.step(i / 10.0);
    for (const std::string& line : world.printed()) all.push_back(line);
  }
  CHECK(all == scripts::Lines{"0", "1", "2", "3", "4", "5"});
  const scripts::Lines problems = world.problems();
  REQUIRE(problems.size() >= 1);
  CHECK(problems.front().find("used the time for programs in this step") != std::string::npos);
}

}  // namespace gs::app::script_batches_test
