// Tests of Scripts with programs in a confined child process.
#include "app/script/process/program_process.h"

#include "app/base/world_work.h"
#include "tests/app/program.h"
#include "tests/app/script/scripts.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

namespace gs::app::program_process_test {
namespace {

// With this variable, all tests of Scripts in this program use child processes.
[[maybe_unused]] const bool all_in_children = [] {
  if (!std::getenv("GHOSTSPACE_SCRIPTS_IN_CHILD")) return false;
  script::set_program_of_scripts(program());
  return true;
}();

/// Guard: Scripts run in children while it exists.
struct InChildren {
  InChildren() { script::set_program_of_scripts(program()); }
  ~InChildren() {
    if (!all_in_children) script::set_program_of_scripts({});
    set_stop_request({});
  }
};

// A number that the engine parses for hours, inside one operator that it cannot interrupt.
const std::string kHangs = "print(+('0.' + '1'.repeat(1 << 23)));";

std::string world_of(const std::string& program, const std::string& interface = {}) {
  return "DEF S Script { directOutput TRUE " + interface + " url \"javascript: " + program + "\" }";
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

TEST_CASE("runs the programs of a world in a child") {
  const InChildren children;
  scripts::World world(
      "DEF T Transform { translation 1 2 3 }" +
      world_of("function initialize() { print(t.translation); t.translation = new SFVec3f(4, 5, 6);"
               " print(t.translation); n = Browser.createVrmlFromString('Shape {}')[0]; print(n.getNodeTypeName());"
               " print(kept.length); kept[3] = 7; } function shutdown() { print('end'); }",
               "field SFNode t USE T field SFNode n NULL field MFInt32 kept [ 1 2 ]"));
  world.start();
  CHECK(world.problems() == scripts::Lines{});
  CHECK(world.printed() == scripts::Lines{"1 2 3", "4 5 6", "Shape", "2"});
  world.end();
  CHECK(world.printed() == scripts::Lines{"end"});
}

TEST_CASE("kills a child with a program that cannot be interrupted, and goes on without programs") {
  const InChildren children;
  Limits limits;
  limits.script_seconds = 0.2;
  scripts::World world("DEF C TimeSensor { loop TRUE }" + world_of("function initialize() { " + kHangs + " }") +
                           " DEF O Script { url \"javascript: function initialize() { print('never'); }\" }",
                       limits);
  const auto from = std::chrono::steady_clock::now();
  world.start();
  CHECK(seconds_since(from) < 10);
  CHECK(world.printed() == scripts::Lines{});
  const scripts::Lines problems = world.problems();
  REQUIRE(problems.size() == 1);
  CHECK(problems.front().find("Script S: the program exceeded the time limit and cannot be interrupted; all programs "
                              "of this world end") != std::string::npos);
  CHECK(world.runner().stopped() == "the program exceeded the time limit");
  world.step(1);
  CHECK(world.runner().evaluate(world.scene(), world.node("O"), "1").failed);
}

TEST_CASE("ends programs at once when the user asks for it") {
  const InChildren children;
  const auto from = std::chrono::steady_clock::now();
  set_stop_request([&] { return seconds_since(from) > 0.3; });
  scripts::World world(world_of("function initialize() { while (true); }"));
  world.start();
  CHECK(seconds_since(from) < 2);
  CHECK(world.runner().stopped() == "the user has stopped the programs");
}

TEST_CASE("interrupts an endless loop in a child without killing it") {
  const InChildren children;
  Limits limits;
  limits.script_seconds = 0.1;
  scripts::World world(world_of("function initialize() { while (true); }") +
                           " DEF O Script { url \"javascript: function initialize() { print('also'); }\" }",
                       limits);
  world.start();
  CHECK(world.printed() == scripts::Lines{"also"});
  CHECK(world.runner().stopped().empty());
  const scripts::Lines problems = world.problems();
  REQUIRE(problems.size() == 1);
  CHECK(problems.front().find("the program exceeded the time limit (fault 1 of 3)") != std::string::npos);
}

TEST_CASE("reports a child that ends by itself once") {
  const InChildren children;
  script::set_program_of_scripts("/bin/true");
  scripts::World world(world_of("function initialize() { print('no'); }"));
  world.start();
  CHECK(world.printed() == scripts::Lines{});
  const scripts::Lines problems = world.problems();
  REQUIRE(problems.size() == 1);
  CHECK(problems.front().find("Script S: the process for programs ended; all programs of this world end") !=
        std::string::npos);
}

TEST_CASE("carries large values between a world and its child") {
  const InChildren children;
  scripts::World world(
      world_of("function initialize() { text = 'ab'.repeat(400000);"
               " other.point = new MFVec3f(new SFVec3f(1, 2, 3)); print(text.length); }",
               "field SFString text \"\" field SFNode other DEF P Coordinate {}"));
  world.start();
  CHECK(world.problems() == scripts::Lines{});
  CHECK(world.printed() == scripts::Lines{"800000"});
}

}  // namespace gs::app::program_process_test
