#include "tests/app/script/scripts.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>

namespace gs::app::script_evaluation_test {

using scripts::Lines;
using scripts::World;

// Returns the value of a line, or "! " and its error.
std::string evaluate(World& world, const char* script, const std::string& line) {
  world.execution().cascade().begin_update();
  const ScriptRunner::Evaluation made = world.runner().evaluate(world.scene(), world.node(script), line);
  world.execution().cascade().drain();
  return (made.failed ? "! " : "") + made.text;
}

TEST_CASE("runs a line as part of a Script's program") {
  World world(
      "DEF S Script { field SFInt32 count 3 eventOut SFFloat out field MFString names [ \"a\" \"b\" ] directOutput "
      "TRUE "
      "url \"javascript: var own = 5; function twice(x) { return 2 * x; } function initialize() {}\" } "
      "DEF M Material {} ROUTE S.out TO M.transparency");
  world.start();
  const std::pair<const char*, const char*> results[] = {
      {"1 + 1", "2"},
      {"twice(own) + count", "13"},
      {"'a' + 'b'", "\"ab\""},
      {"names.length", "2"},
      {"var more = 7", "undefined"},
      {"more", "7"},
      {"new SFVec3f(1, 2, 3)", "1 2 3"},
  };
  for (const auto& [line, result] : results) CHECK(evaluate(world, "S", line) == result);
  // VRML97 C.5.2: events continue afterwards.
  world.take();
  CHECK(evaluate(world, "S", "out = 0.5") == "0.5");
  CHECK(world.take(".transparency").size() == 1);
  CHECK(evaluate(world, "S", "print('hello')") == "undefined");
  CHECK(world.printed() == Lines{"hello"});
}

TEST_CASE("runs the promise jobs of a line before its value is shown") {
  World world("DEF S Script { url \"javascript: var seen = 0;\" }");
  world.start();
  CHECK(evaluate(world, "S",
                 "Promise.resolve(7).then(function(v) { seen = v; return 8; }).then(function(v) { seen += v; }); 1") ==
        "1");
  CHECK(evaluate(world, "S", "seen") == "15");
  CHECK(evaluate(world, "S", "Promise.resolve(0).then(function() { print('later'); })").find("!") != 0);
  CHECK(world.printed() == Lines{"later"});
  // VRML97 C.5.2: assignments of jobs are sent as well. The jobs of a line that fails run too, as in programs.
  CHECK(evaluate(world, "S", "Promise.resolve(3).then(function(v) { seen = v; }); throw 'mine'").starts_with("! "));
  CHECK(evaluate(world, "S", "seen") == "3");
  CHECK(world.problems().empty());
}

TEST_CASE("reports each error of a line, and counts it as no fault of the program") {
  World world("DEF S Script { url \"javascript: function initialize() { print('here'); }\" }");
  world.start();
  for (int i = 0; i < 5; ++i) {
    CHECK(evaluate(world, "S", "missing + 1").find("! console:1:1: error: ReferenceError: missing is not defined") ==
          0);
    CHECK(evaluate(world, "S", "1 +").find("SyntaxError") != std::string::npos);
    CHECK(evaluate(world, "S", "throw 'mine'").starts_with("! "));
    CHECK(evaluate(world, "S", "({toString: function() { throw 1; }})").starts_with("! "));
  }
  CHECK(world.problems().empty());
  CHECK(evaluate(world, "S", "1") == "1");
}

TEST_CASE("applies the time and memory limits of programs to a line") {
  Limits limits;
  limits.script_seconds = 0.05;
  limits.script_heap = std::size_t{8} << 20;
  World world("DEF S Script { url \"javascript: ;\" }", limits);
  world.start();
  CHECK(evaluate(world, "S", "while (true) ;") == "! it exceeded the time limit");
  CHECK(evaluate(world, "S", "var a = []; while (true) a.push('x' + a.length)").starts_with("! it "));
  CHECK(evaluate(world, "S", "2") == "2");
}

TEST_CASE("reports that no program runs") {
  World world(
      "DEF Java Script { url \"some.class\" } DEF Empty Script {} DEF Far Script { url \"far.js\" } DEF G Group {} "
      "DEF Bad Script { url \"javascript: function initialize( {\" }");
  world.start();
  const std::pair<const char*, const char*> results[] = {
      {"Java", "! this Script has no running program"},         {"Empty", "! this Script has no running program"},
      {"Far", "! the program of this Script is still loading"}, {"Bad", "! this Script has no running program"},
      {"G", "! not a Script, or its program has not started"},
  };
  for (const auto& [script, result] : results) CHECK(evaluate(world, script, "1") == result);
}

// vrmlscript: contains programs of the same language (C.3.1).
TEST_CASE("runs lines in old VRMLScript programs") {
  World world("DEF S Script { field SFFloat x 2 url \"vrmlscript: function initialize() {}\" }");
  world.start();
  CHECK(evaluate(world, "S", "x * 2") == "4");
}

}  // namespace gs::app::script_evaluation_test
