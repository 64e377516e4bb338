#include "scripts.h"

namespace gs::app::script_limits_test {

using scripts::Lines;
using scripts::run;
using scripts::value;
using scripts::World;

namespace {

Limits small_limits() {
  Limits limits;
  limits.script_seconds = 0.2;
  limits.script_heap = std::size_t{24} << 20;
  return limits;
}

/// Runs initialize() of a Script, then an event in another Script. Returns the reported problem.
std::string problem_of(const std::string& program, const std::string& interface = {},
                       const Limits& limits = small_limits()) {
  World world("DEF Bad Script { directOutput TRUE " + interface + " url \"javascript: function initialize() { " +
                  program +
                  " }\" } DEF Good Script { eventIn SFBool go url \"javascript: function go() { print('good'); }\" }",
              limits);
  world.start();
  world.send_at(1, "Good.go", true);
  CHECK(world.printed() == Lines{"good"});
  const Lines problems = world.problems();
  REQUIRE(problems.size() == 1);
  return problems.front();
}

}  // namespace

TEST_CASE("stops an endless program, which cannot catch that") {
  const std::string stopped = "text.wrl:2:9: error: Script Bad: the program exceeded the time limit (fault 1 of 3)";
  CHECK(problem_of("for (;;) {}") == stopped);
  CHECK(problem_of("for (;;) try { for (;;) {} } catch (e) {} finally { for (;;) {} }") == stopped);
  CHECK(problem_of("Promise.resolve().then(function () { for (;;) {} });") == stopped);
}

TEST_CASE("stops a regular expression that explodes") {
  const std::string problem = problem_of("/^(a+)+$/.test('aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa!');");
  INFO(problem);
  CHECK(problem.find("(fault 1 of 3)") != std::string::npos);
}

TEST_CASE("stops a program with endless recursion") {
  const std::string problem = problem_of("function f(n) { return f(n + 1) + 1; } f(0);");
  CHECK(problem.find("too much recursion (fault 1 of 3)") != std::string::npos);
}

TEST_CASE("stops a program that exceeds its memory") {
  const std::string stopped = "the program exceeds the";
  Limits limits = small_limits();
  limits.script_seconds = 100;
  for (const std::string program :
       {"var a = []; for (;;) a.push(new Array(1000).fill(1));", "var a = []; for (;;) a.push('x' + a.length);",
        "var a = []; for (;;) a.push(new SFVec3f(1, 2, 3));", "var a = []; for (;;) a.push(new MFFloat(1, 2, 3));",
        "var m = new MFFloat(); for (var i = 1000;; i *= 2) m[i] = i;"}) {
    INFO(program);
    CHECK(problem_of(program, {}, limits).find(stopped) != std::string::npos);
  }
  CHECK(problem_of("for (var i = 1000;; i *= 2) f[i] = i;", "field MFFloat f []", limits).find(stopped) !=
        std::string::npos);
  CHECK(problem_of("f.length = 60000000;", "field MFVec3f f []").find("memory") != std::string::npos);
}

TEST_CASE("switches a Script off after three faults") {
  World world("DEF S Script { eventIn SFBool go url \"javascript: function go() { print('runs'); for (;;) {} }\" }",
              small_limits());
  world.start();
  for (int i = 1; i <= 5; ++i) {
    world.send_at(i, "S.go", true);
  }
  CHECK(world.printed() == Lines{"runs", "runs", "runs"});
  const Lines problems = world.problems();
  REQUIRE(problems.size() == 3);
  CHECK(
      problems.back() ==
      "text.wrl:2:7: error: Script S: the program exceeded the time limit; this third fault switches the program off");
}

TEST_CASE("confines programs to their world") {
  CHECK(
      gs::app::scripts::value("typeof require + typeof load + typeof read + typeof os + typeof fetch + typeof Worker + "
                              "typeof WebAssembly + typeof SharedArrayBuffer + typeof ArrayBuffer") ==
      "undefinedundefinedundefinedundefinedundefinedundefinedundefinedundefinedundefined");
}

TEST_CASE("ends a storm of events between Scripts with each timestamp (4.10.4)") {
  World world(
      "DEF A Script { eventIn SFInt32 in_ eventOut SFInt32 out url \"javascript: function in_(v) { out = v + 1; }\" }"
      "DEF B Script { eventIn SFInt32 in_ eventOut SFInt32 out url \"javascript: function in_(v) { out = v + 1; }\" }"
      "ROUTE A.out TO B.in_ ROUTE B.out TO A.in_");
  world.start();
  world.send_at(1, "A.in_", std::int32_t{0});
  CHECK(world.take() == Lines{"1 A.out 1", "1 B.out 2"});
}

TEST_CASE("removes a Script that removes its own node, with its memory") {
  World world(
      "DEF G Group { children DEF S Script { directOutput TRUE field SFNode g USE G eventIn SFBool go url "
      "\"javascript: "
      "function go() { g.children = new MFNode(); print('gone'); } \" } }");
  world.start();
  world.send_at(1, "S.go", true);
  world.step(2);
  CHECK(world.printed() == Lines{"gone"});
  CHECK(world.problems() == Lines{});
}

TEST_CASE("frees nodes that a program makes and discards each frame") {
  World world(
      "DEF C TimeSensor { loop TRUE } DEF G Group {} DEF S Script { directOutput TRUE field SFNode g USE G eventIn "
      "SFTime "
      "tick url \"javascript: function tick(t) { for (var i = 0; i < 20; ++i) g.children = "
      "Browser.createVrmlFromString('Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 1 1 ] } } "
      "}'); }\" }"
      "ROUTE C.time TO S.tick");
  world.start();
  std::size_t most = 0;
  for (int i = 1; i <= 400; ++i) {
    world.step(i * 0.1);
    most = std::max(most, world.scene().nodes().count());
  }
  // of 32,000 nodes in all
  CHECK(most < 12'000);
}

TEST_CASE("stops programs that send, request, print or create endlessly, and runs the world on") {
  // Runs each program every frame without a fault of the engine.
  for (const std::string program :
       {"for (var i = 0; i < 5000; ++i) Browser.loadURL('x.wrl');",
        "for (var i = 0; i < 5000; ++i) Browser.createVrmlFromURL('x.wrl', me, 'made');",
        "for (var i = 0; i < 5000; ++i) { Browser.setDescription('x' + i); Browser.print(i); }",
        "for (var i = 0; i < 1000; ++i) { Browser.addRoute(me, 'out', me, 'again'); Browser.deleteRoute(me, 'out', me, "
        "'again'); }",
        "for (var i = 0; i < 2000; ++i) me.again = i;",
        "g.children = Browser.createVrmlFromString('Group { children [' + new Array(2000).join('Shape { } ') + '] "
        "}');"}) {
    INFO(program);
    World world(
        "DEF C TimeSensor { loop TRUE } DEF G Group { } DEF S Script { directOutput TRUE field SFNode me USE S "
        "field SFNode g USE G eventIn SFTime tick eventIn MFNode made eventIn SFInt32 again eventOut SFInt32 out "
        "field SFInt32 n 0 url \"javascript: function tick(t) { ++n; " +
        program + " } function again(v) { out = v; }\" } ROUTE C.time TO S.tick");
    world.start();
    std::size_t requests = 0, most_nodes = 0;
    for (int i = 1; i <= 30; ++i) {
      world.step(i * 0.1);
      requests = std::max(requests, world.runner().take_requests().size());
      most_nodes = std::max(most_nodes, world.scene().nodes().count());
    }
    CHECK(requests <= 256);
    CHECK(most_nodes < 40'000);  // of 60,000 nodes in all
    CHECK(std::get<std::int32_t>(*world.execution().cascade().last_value(
              world.scene(), world.node("S"), *world.scene().node(world.node("S")).type->find_field("n"))) >= 30);
  }
}

TEST_CASE("limits the events that a Script may send to itself at one timestamp (4.10.4)") {
  World world(
      "DEF S Script { directOutput TRUE field SFNode me USE S eventIn SFInt32 again field SFInt32 n 0 url "
      "\"javascript: "
      "function again(v) { ++n; me.again = v + 1; }\" }");
  world.start();
  const auto calls = [&] {
    return std::get<std::int32_t>(*world.execution().cascade().last_value(
        world.scene(), world.node("S"), *world.scene().node(world.node("S")).type->find_field("n")));
  };
  world.send_at(1, "S.again", std::int32_t{0});
  const std::int32_t first = calls();
  CHECK(first > 10'000);  // more than the 1,000 Scripts of a large world
  CHECK(first < 100'000);
  CHECK(world.execution().budget().problem().find("exceed the limit of work") != std::string::npos);
  world.send_at(2, "S.again", std::int32_t{0});
  CHECK(calls() > first);
}

TEST_CASE("keeps the memory of a world constant that recreates itself with its program each frame") {
  World world(
      "DEF C TimeSensor { loop TRUE } DEF S Script { eventIn SFTime tick url \"javascript: function tick(t) { print(t);"
      "var q = String.fromCharCode(34); Browser.replaceWorld(Browser.createVrmlFromString('DEF C TimeSensor { loop "
      "TRUE }"
      "DEF S Script { eventIn SFTime tick url ' + q + 'javascript: ' + tick + q + ' } ROUTE C.time TO S.tick')); }\" }"
      "ROUTE C.time TO S.tick");
  world.start();
  std::size_t most = 0;
  for (int i = 1; i <= 50; ++i) {
    world.step(i * 0.1);
    most = std::max(most, world.scene().nodes().count());
  }
  // A TimeSensor that a program makes starts immediately. It runs the Script that was made with it, which makes the
  // next TimeSensor: 64 times per timestamp.
  const std::size_t times = world.printed().size();
  CHECK(times >= 50);
  CHECK(times <= 51 * 64);
  CHECK(world.problems() == Lines{});
  CHECK(world.scene().roots().size() == 2);
  CHECK(most < 5'000);
}

TEST_CASE("keeps the memory of a world constant that replaces itself each frame") {
  World world(
      "DEF C TimeSensor { loop TRUE } DEF S Script { eventIn SFTime tick url \"javascript: "
      "function tick(t) { Browser.replaceWorld(Browser.createVrmlFromString('DEF C TimeSensor { loop TRUE } DEF S "
      "Script { "
      "eventIn SFTime tick url \\\"javascript: function tick() { print(2); }\\\" } ROUTE C.time TO S.tick')); }\" }"
      "ROUTE C.time TO S.tick");
  world.start();
  for (int i = 1; i <= 5; ++i) world.step(i * 0.1);
  CHECK(world.printed().size() >= 3);
  CHECK(world.scene().roots().size() == 2);
}

TEST_CASE("postpones programs beyond the time of a step to the next one") {
  World world(
      "DEF A Script { eventIn SFInt32 in_ url \"javascript: function in_(v) { var end = Date.now() + 30; while "
      "(Date.now() < "
      "end); print('a' + v); }\" } DEF B Script { eventIn SFInt32 in_ url \"javascript: function in_(v, t) { print('b' "
      "+ v + ' ' "
      "+ t); }\" }",
      {}, {0.01, false});
  world.start();
  world.send_at(1, "A.in_", std::int32_t{1});
  world.send("B.in_", std::int32_t{2});
  CHECK(world.printed() == Lines{"a1"});
  CHECK(world.runner().is_late());
  world.step(2);
  CHECK(world.printed() == Lines{"b2 1001"});
  CHECK(world.problems() == Lines{"text.wrl:2:7: warning: Script A: used the time for programs in this step; remaining "
                                  "events wait for the next step"});
  CHECK_FALSE(world.runner().is_late());
}

}  // namespace gs::app::script_limits_test
