#include "scripts.h"

namespace gs::app::script_events_test {

using scripts::Lines;
using scripts::run;
using scripts::value;
using scripts::World;

TEST_CASE("calls the function of an eventIn's name with value and timestamp (4.12.8, C.4.2)") {
  World world("DEF S Script { eventIn SFVec3f move url \"javascript: function move(v, t) { print(v + ' ' + t); }\" }");
  world.start();
  world.send_at(2, "S.move", vrml::SFVec3f(1, 2, 3));
  CHECK(world.printed() == Lines{"1 2 3 1002"});
}

TEST_CASE("calls initialize() before any event, and shutdown() at the end (4.12.3)") {
  World world(
      "DEF C TimeSensor { loop TRUE } DEF S Script { eventIn SFBool active url \"javascript: function initialize() {"
      "print('begin'); } function active() { print('active'); } function shutdown() { print('end'); }\" }"
      "ROUTE C.isActive TO S.active");
  world.start();
  CHECK(world.printed() == Lines{"begin", "active"});
  world.end();
  CHECK(world.printed() == Lines{"end"});
}

TEST_CASE("sends a program's events after its function, with the timestamp of its event (4.10.3, C.5.3)") {
  World world(
      "DEF T Transform {} DEF S Script { eventIn SFFloat in eventOut SFVec3f out eventOut SFBool done url "
      "\"javascript: "
      "function in_(v) {} function go(v) { out = new SFVec3f(1, 0, 0); done = TRUE; out = new SFVec3f(2, 0, 0);"
      "print(out); }\" eventIn SFFloat go } ROUTE S.out TO T.set_translation");
  world.start();
  world.send_at(3, "S.go", 1.0f);
  CHECK(world.printed() == Lines{"2 0 0"});
  CHECK(world.take() == Lines{"3 S.out 2 0 0", "3 S.done TRUE", "3 T.translation 2 0 0"});
}

TEST_CASE("returns the initial value of an eventOut's type before it sends (4.10.1)") {
  World world(
      "DEF S Script { eventOut SFRotation r eventOut SFString s eventOut MFInt32 m eventOut SFBool b"
      " url \"javascript: function initialize() { print(r + '|' + s + '|' + m.length + '|' + b); }\" }");
  world.start();
  CHECK(world.printed() == Lines{"0 0 1 0||0|false"});
}

TEST_CASE("calls eventsProcessed() once per cascade, after its events (4.12.4)") {
  World world(
      "DEF A Script { eventIn SFBool go eventOut SFBool one eventOut SFBool two url \"javascript: "
      "function go() { one = TRUE; two = TRUE; }\" }"
      "DEF B Script { eventIn SFBool one eventIn SFBool two eventOut SFInt32 out field SFInt32 n 0 url \"javascript: "
      "function one() { ++n; print('one'); } function two() { ++n; print('two'); }"
      "function eventsProcessed() { print('processed'); out = n; }\" }"
      "ROUTE A.one TO B.one ROUTE A.two TO B.two");
  world.start();
  world.send_at(1, "A.go", true);
  CHECK(world.printed() == Lines{"one", "two", "processed"});
  CHECK(world.take("B.") == Lines{"1 B.out 2"});
}

TEST_CASE("calls eventsProcessed() in the next cascade if the cascade returns to the Script (4.12.4)") {
  World world(
      "DEF A Script { eventIn SFBool go eventIn SFInt32 back eventOut SFInt32 out url \"javascript: "
      "function go() { print('go'); } function back() { print('back'); }"
      "function eventsProcessed() { print('processed'); out = 1; }\" }"
      "DEF B Script { eventIn SFInt32 in_ eventOut SFInt32 out url \"javascript: function in_(v) { out = v; }\" }"
      "ROUTE A.out TO B.in_ ROUTE B.out TO A.back");
  world.start();
  world.send_at(1, "A.go", true);
  CHECK(world.printed() == Lines{"go", "processed", "back"});
  world.step(2);
  CHECK(world.printed() == Lines{"processed", "back"});
}

TEST_CASE("writes to nodes with directOutput, and sends the last assigned value at the end (4.12.5, C.5.2)") {
  World world(
      "DEF T Transform {} DEF S Script { directOutput TRUE field SFNode node USE T eventIn SFFloat go url "
      "\"javascript: "
      "function go(v) { node.set_translation = new SFVec3f(v, 0, 0); node.translation = new SFVec3f(v, 1, 0);"
      "print(node.translation_changed); node.scale = node.scale.multiply(2); }\" }");
  world.start();
  world.send_at(1, "S.go", 4.0f);
  CHECK(world.take() == Lines{"1 T.translation 4 1 0", "1 T.scale 2 2 2"});
  CHECK(world.printed() == Lines{"4 1 0"});
  CHECK(world.problems() == Lines{});
}

TEST_CASE("warns of a write with directOutput FALSE, and performs it (4.12.5)") {
  World world(
      "DEF T Transform {} DEF S Script { field SFNode node USE T url \"javascript: function initialize() {"
      "node.translation = new SFVec3f(1, 0, 0); }\" }");
  world.start();
  CHECK(world.take() == Lines{"0 T.translation 1 0 0"});
  CHECK(world.problems() ==
        Lines{"text.wrl:2:26: warning: Script S: writes to other nodes with directOutput FALSE (VRML97 4.12.5)"});
}

TEST_CASE("lets a Script read itself, and the eventIns and eventOuts of others (4.12.9.2)") {
  World world(
      "DEF A Script { eventIn SFInt32 set eventOut SFInt32 value_changed url \"javascript: "
      "function set(v) { value_changed = v + 1; }\" }"
      "DEF B Script { directOutput TRUE field SFNode me USE B field SFNode a USE A eventIn SFInt32 ask eventIn SFInt32 "
      "tell url \"javascript: function ask(v) { a.set = v; me.tell = v; } function tell(v) {"
      "print(a.value_changed + ' ' + v); }\" }");
  world.start();
  world.send_at(1, "B.ask", std::int32_t{4});
  CHECK(world.printed() == Lines{"5 4"});
}

TEST_CASE("adds and deletes ROUTEs by Browser.addRoute and deleteRoute (4.12.10)") {
  World world(
      "DEF C TouchSensor {} DEF T Transform {} DEF S Script { directOutput TRUE field SFNode t USE T field SFNode me "
      "USE S "
      "eventIn SFVec3f on eventIn SFBool add eventIn SFBool remove eventOut SFVec3f out url \"javascript: "
      "function add() { Browser.addRoute(me, 'out', t, 'set_translation'); out = new SFVec3f(1, 0, 0); }"
      "function remove() { Browser.deleteRoute(me, 'out', t, 'translation'); out = new SFVec3f(2, 0, 0); }\" }");
  world.start();
  world.send_at(1, "S.add", true);
  world.send_at(2, "S.remove", true);
  CHECK(world.take() == Lines{"1 S.out 1 0 0", "1 T.translation 1 0 0", "2 S.out 2 0 0"});
}

TEST_CASE("delivers requested files later, as an event with its own timestamp (4.12.6)") {
  World world(
      "DEF A Script { field SFNode me USE A eventIn SFBool go eventIn MFNode came eventOut SFInt32 out url "
      "\"javascript: "
      "function go() { Browser.createVrmlFromURL('x.wrl', me, 'came'); } function came(nodes, t) { print(t);"
      "out = nodes.length; }\" }"
      "DEF B Script { field SFNode a USE A eventIn SFInt32 in_ directOutput TRUE url \"javascript: function in_(v, t) {"
      "print('b ' + t); a.came = new MFNode(); }\" } ROUTE A.out TO B.in_");
  world.start();
  world.send_at(1, "A.go", true);
  CHECK(world.printed() == Lines{});
  const std::vector<ScriptRequest> requests = world.runner().take_requests();
  REQUIRE(requests.size() == 1);
  // An event is received between two steps. It is sorted after the earlier event, and its loop ends (4.10.4).
  world.step(2.5);
  CHECK(world.created(requests[0], "#VRML V2.0 utf8\nGroup {}", "x.wrl"));
  CHECK(world.take("A.out") == Lines{"2.5 A.out 1"});
  CHECK(world.printed() == Lines{"1002.5", "b 1002.5", "1002.5"});
}

TEST_CASE("repeats Date and Math.random in simulated time") {
  const auto seen = [] {
    World world(
        "DEF S Script { eventIn SFBool go url \"javascript: function go() { print(Date.now(), new Date().getTime(), "
        "+new "
        "Date(0), Math.random()); var end = Date.now() + 500, looks = 0; while (Date.now() < end) ++looks; print(looks "
        "> "
        "0); }\" }");
    world.start();
    world.send_at(1.25, "S.go", true);
    world.send_at(2, "S.go", true);
    CHECK(world.problems() == Lines{});
    return world.printed();
  };
  const Lines lines = seen();
  REQUIRE(lines.size() == 4);
  CHECK(lines[0].starts_with("1001250 1001250 0 0."));
  CHECK(lines[1] == "true");
  CHECK(lines[2].starts_with("1002000 1002000 0 0."));
  CHECK(lines[0].substr(18) != lines[2].substr(18));
  CHECK(seen() == lines);
  // In a window, Date uses the machine's clock.
  World window("DEF S Script { url \"javascript: function initialize() { print(Date.now() > 1500000000000); }\" }", {},
               {0, false});
  window.start();
  CHECK(window.printed() == Lines{"true"});
}

TEST_CASE("createVrmlFromString returns nodes that can be added to the world (4.12.10)") {
  World world(
      "DEF G Group {} DEF S Script { directOutput TRUE field SFNode g USE G eventIn SFInt32 go url \"javascript: "
      "function go(n) { var made = Browser.createVrmlFromString('Shape {} DEF X Transform {} PROTO P [] { Group {} } P "
      "{}'); print(made.length); g.addChildren = made; for (var i = 0; i < n; i++) g.addChildren = new MFNode("
      "new SFNode('Group {}')); }\" }");
  world.start();
  world.send_at(1, "S.go", std::int32_t{2});
  CHECK(world.printed() == Lines{"3"});
  CHECK(world.scene().get<vrml::MFNode>(world.node("G"), "children").size() == 5);
  CHECK(world.problems() == Lines{});
}

TEST_CASE("runs a Script made at run time before its first event, and ends it with its node (4.12.3)") {
  World world(
      "DEF G Group {} DEF S Script { directOutput TRUE field SFNode g USE G eventIn SFInt32 go url \"javascript: "
      "function go(n) { if (n == 0) { g.children = new MFNode(); return; } var s = new SFNode('Script { eventIn "
      "SFInt32 in_ "
      "url \\\"javascript: function initialize() { print(1); } function in_(v) { print(v); } function shutdown() {"
      "print(9); }\\\" }'); g.children = new MFNode(s); s.in_ = 5; }\" }");
  world.start();
  world.send_at(1, "S.go", std::int32_t{1});
  CHECK(world.printed() == Lines{"1", "5"});
  world.send_at(2, "S.go", std::int32_t{0});
  world.end();
  CHECK(world.printed() == Lines{"9"});
}

TEST_CASE("passes values, events and url to a Script in a PROTO by IS (4.8.2)") {
  World world(
      "PROTO P [ field SFInt32 add 1 eventIn SFInt32 in_ eventOut SFInt32 out field MFString url [] ] {"
      "Script { field SFInt32 add IS add eventIn SFInt32 in_ IS in_ eventOut SFInt32 out IS out url IS url } }"
      "DEF A P { add 5 url \"javascript: function in_(v) { out = v + add; }\" }"
      "DEF B P { url \"vrmlscript: function in_(v) { out = v * 10; }\" }");
  world.start();
  world.send_at(1, "A.in_", std::int32_t{2});
  world.send("B.in_", std::int32_t{3});
  CHECK(world.take(" A.out") == Lines{"1 A.out 7"});
}

TEST_CASE("runs the first of several urls that can be run (4.12.1)") {
  World world(
      "DEF S Script { url [ \"Applet.class\" \"java:x\" \"javascript: function initialize( { \""
      "\"ECMAScript: function initialize() { print('third'); }\" ] }");
  world.start();
  CHECK(world.printed() == Lines{"third"});
  CHECK(world.problems().size() == 2);
}

TEST_CASE("runs the program of a url that is set (6.40)") {
  World world(
      "DEF S Script { url \"javascript: function initialize() { print(1); } function shutdown() { print(2); }\" }");
  world.start();
  world.send_at(1, "S.set_url", vrml::MFString{vrml::SFString("javascript: function initialize() { print(3); }")});
  CHECK(world.printed() == Lines{"1", "2", "3"});
}

TEST_CASE("replaceWorld ends the world's Scripts and shows other nodes (4.12.10)") {
  World world(
      "DEF S Script { eventIn SFBool go url \"javascript: function go() { Browser.replaceWorld("
      "Browser.createVrmlFromString('Shape {}')); print('still here'); } function shutdown() { print('over'); }\" }");
  world.start();
  world.send_at(1, "S.go", true);
  CHECK(world.printed() == Lines{"still here", "over"});
  REQUIRE(world.scene().roots().size() == 1);
  CHECK(world.scene().node(world.scene().roots()[0]).type->name == "Shape");
}

TEST_CASE("reports an exception with file, line and column, and continues the program (C.4)") {
  World world(
      "DEF S Script { eventIn SFInt32 go url \"javascript:\n  function go(v) {\n    if (v == 1) nothing();\n"
      "    print(v);\n  }\" }");
  world.start();
  for (std::int32_t i = 0; i < 3; ++i) {
    world.send_at(1 + i, "S.go", i);
  }
  CHECK(world.printed() == Lines{"0", "2"});
  CHECK(world.problems() == Lines{"text.wrl:4:17: error: Script S: ReferenceError: nothing is not defined"});
  // In the first line too, the reported position is that in the file.
  World first("Script { url \"javascript:nothing();\" }");
  first.start();
  CHECK(first.problems() == Lines{"text.wrl:2:26: error: Script: ReferenceError: nothing is not defined"});
}

TEST_CASE("returns keyValue[0] as value_changed of an interpolator before any fraction (4.6.8)") {
  scripts::World world(
      "DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 1 2 3, 4 5 6 ] } DEF C ColorInterpolator { key [ 0 1 ] "
      "keyValue [ 1 0 0, 0 0 1 ] } DEF O OrientationInterpolator { key 0 keyValue 0 1 0 2 } DEF N ScalarInterpolator { "
      "key [ 0 1 ] keyValue [ 7 9 ] } DEF L CoordinateInterpolator { key [ 0 1 ] keyValue [ 1 1 1, 2 2 2, 3 3 3, 4 4 4 "
      "] "
      "} DEF E ScalarInterpolator { } DEF S Script { field SFNode p USE P field SFNode c USE C field SFNode o USE O "
      "field SFNode n USE N field SFNode l USE L field SFNode e USE E eventIn SFBool go url \"javascript: function "
      "initialize() { all(); } function go() { all(); } function all() { print(p.value_changed); "
      "print(c.value_changed); print(o.value_changed); print(n.value_changed); print(l.value_changed); "
      "print(e.value_changed); }\" }");
  world.start();
  CHECK(world.problems() == scripts::Lines{});
  CHECK(world.printed() == scripts::Lines{"1 2 3", "1 0 0", "0 1 0 2", "7", "[ 1 1 1, 2 2 2 ]", "0"});
  world.send("N.keyValue", vrml::MFFloat{5, 6});
  world.send_at(1, "N.set_fraction", vrml::SFFloat{1});
  world.send_at(2, "N.keyValue", vrml::MFFloat{3, 4});
  world.send("S.go", true);
  // After the first event, the eventOut has the last sent value.
  const scripts::Lines lines = world.printed();
  REQUIRE(lines.size() == 6);
  CHECK(lines[0] == "1 2 3");
  CHECK(lines[3] == "6");
}

}  // namespace gs::app::script_events_test
