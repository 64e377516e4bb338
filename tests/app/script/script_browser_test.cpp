#include "scripts.h"

namespace gs::app::script_browser_test {

using scripts::Lines;
using scripts::run;
using scripts::value;
using scripts::World;

TEST_CASE("Browser: reports name, version, viewer speed, frame rate and the world's URL (4.12.10)") {
  World world(
      "DEF S Script { eventIn SFBool go url \"javascript: function go() { print(Browser.getName() + (Browser."
      "getVersion().length > 0)); print(Browser.getCurrentSpeed() + ' ' + Browser.getCurrentFrameRate() + ' ' + "
      "Browser.getWorldURL()); }\" }");
  world.start();
  world.runner().set_browser({"file:///a/b.wrl", 2.5, 60});
  world.send_at(1, "S.go", true);
  CHECK(world.printed() == Lines{"GhostSpacetrue", "2.5 60 file:///a/b.wrl"});
}

TEST_CASE("Browser: reports 100 pictures a second before the first picture (4.12.10.3)") {
  CHECK(value("Browser.getCurrentFrameRate() + ' ' + Browser.getCurrentSpeed()") == "100 0");
}

TEST_CASE("Browser: passes loadURL and setDescription to the caller (4.12.10)") {
  World world(
      "DEF S Script { url \"javascript: function initialize() { Browser.loadURL(new MFString('a.wrl#V', 'b.wrl'), "
      "new MFString('target=x')); Browser.loadURL('c.wrl'); Browser.setDescription('text'); }\" }");
  world.start();
  const std::vector<ScriptRequest> requests = world.runner().take_requests();
  REQUIRE(requests.size() == 3);
  CHECK(requests[0].kind == ScriptRequest::Kind::load_url);
  CHECK(requests[0].urls == std::vector<std::string>{"a.wrl#V", "b.wrl"});
  CHECK(requests[0].parameters == std::vector<std::string>{"target=x"});
  CHECK(requests[0].origin == &world.scene());
  CHECK(requests[1].urls == std::vector<std::string>{"c.wrl"});
  CHECK(requests[2].kind == ScriptRequest::Kind::description);
  CHECK(requests[2].text == "text");
}

TEST_CASE("createVrmlFromURL sends the nodes of a file to an eventIn (4.12.10)") {
  World world(
      "DEF G Group {} DEF S Script { field SFNode me USE S directOutput TRUE field SFNode g USE G eventIn MFNode "
      "loaded "
      "url \"javascript: function initialize() { Browser.createVrmlFromURL(new MFString('x.wrl'), me, 'loaded'); }"
      "function loaded(nodes, t) { print(nodes.length + ' ' + t); g.children = nodes; }\" }");
  world.start();
  const std::vector<ScriptRequest> requests = world.runner().take_requests();
  REQUIRE(requests.size() == 1);
  CHECK(requests[0].kind == ScriptRequest::Kind::create_from_url);
  CHECK(requests[0].urls == std::vector<std::string>{"x.wrl"});
  world.step(2);
  CHECK(world.created(requests[0], "#VRML V2.0 utf8\nShape {} Transform {}", "x.wrl"));
  CHECK(world.printed() == Lines{"2 1002"});
  CHECK(world.take() == Lines{"2 G.children [ Shape, Transform ]"});
}

TEST_CASE("holds events until a program's file is loaded, and tries the next url if it is missing (4.12.1)") {
  World world(
      "DEF A Script { eventIn SFInt32 in_ url [ \"a.js\" \"b.js\" \"javascript: function in_() { print('held'); }\" ] }"
      "DEF B Script { eventIn SFInt32 in_ url [ \"c.js\" \"javascript: function in_(v) { print('held ' + v); }\" ] }");
  world.start();
  const std::vector<ScriptRequest> requests = world.runner().take_requests();
  REQUIRE(requests.size() == 2);
  CHECK(requests[0].kind == ScriptRequest::Kind::program);
  CHECK(requests[0].urls == std::vector<std::string>{"a.js", "b.js"});
  world.send_at(1, "A.in_", std::int32_t{1});
  world.send("B.in_", std::int32_t{2});
  CHECK(world.printed() == Lines{});
  world.step(3);
  world.runner().found(world.scene(), world.node("A"),
                       "function initialize() { print('b'); } function in_(v, t) {"
                       "print(v + ' ' + t); }\nnothing();",
                       "b.js");
  CHECK(world.problems() == Lines{"b.js:2:1: error: Script A: ReferenceError: nothing is not defined"});
  CHECK(world.printed() == Lines{"b", "1 1001"});
  world.runner().found(world.scene(), world.node("B"), std::nullopt, {});
  CHECK(world.printed() == Lines{"held 2"});
}

TEST_CASE("delivers events at once with mustEvaluate TRUE and FALSE (4.12.2)") {
  for (const std::string must : {"TRUE", "FALSE"}) {
    World world("DEF S Script { mustEvaluate " + must +
                " eventIn SFInt32 in_ eventOut SFInt32 out url \"javascript: function "
                "in_(v) { out = v; }\" }");
    world.start();
    world.send_at(1, "S.in_", std::int32_t{3});
    CHECK(world.take() == Lines{"1 S.out 3"});
  }
}

TEST_CASE("accepts 25 eventIns and eventOuts in a Script (7.3.3)") {
  std::string interface, program;
  for (int i = 0; i < 25; ++i) {
    const std::string n = std::to_string(i);
    interface += "eventIn SFInt32 in" + n + " eventOut SFInt32 out" + n + " ";
    program += "function in" + n + "(v) { out" + n + " = v + " + n + "; }";
  }
  World world("DEF S Script { " + interface + " url \"javascript: " + program + "\" }");
  world.start();
  world.step(1);
  for (int i = 0; i < 25; ++i) world.send("S.in" + std::to_string(i), std::int32_t{100});
  const Lines events = world.take();
  REQUIRE(events.size() == 25);
  CHECK(events.back() == "1 S.out24 124");
}

TEST_CASE("throws an exception with its position if createVrmlFromString cannot parse (4.12.10)") {
  World world(
      "DEF S Script { url \"javascript: function initialize() { try { new SFNode(''); } catch (e) { print('caught'); }"
      "print(Browser.createVrmlFromString('Shape { nothing 1 } Group {}').length); }\" }");
  world.start();
  CHECK(world.printed() == Lines{"caught", "2"});
  CHECK(world.problems().size() == 1);
}

TEST_CASE("binds no nodes of createVrmlFromString and createVrmlFromURL by itself (4.6.10)") {
  World world(
      "DEF G Group {} DEF S Script { field SFNode me USE S directOutput TRUE field SFNode g USE G eventIn MFNode "
      "loaded eventIn SFBool go url \"javascript: function initialize() { g.children = Browser.createVrmlFromString("
      "'Viewpoint { } NavigationInfo { } Fog { } Background { }'); Browser.createVrmlFromURL(new MFString('x.wrl'), "
      "me, 'loaded'); } function loaded(nodes) { g.addChildren = "
      "nodes; } function go() { g.children[4].set_bind = true; }\" }");
  world.start();
  const std::vector<ScriptRequest> requests = world.runner().take_requests();
  REQUIRE(requests.size() == 1);
  world.step(1);
  CHECK(world.created(requests[0], "#VRML V2.0 utf8\nViewpoint { position 0 0 7 }", "x.wrl"));
  world.execution().stacks().bind_new_types();
  world.step(2);
  CHECK(world.problems() == Lines{});
  const auto bound = [&](vrml::NodeKind kind) {
    return world.execution().stacks().bound(vrml::built_in_node_type(kind));
  };
  const vrml::NodeId group = world.node("G");
  REQUIRE(world.scene().get<vrml::MFNode>(group, "children").size() == 5);
  for (const vrml::NodeKind kind :
       {vrml::NodeKind::viewpoint, vrml::NodeKind::navigation_info, vrml::NodeKind::fog, vrml::NodeKind::background})
    CHECK(bound(kind).scene == nullptr);
  CHECK(world.take("isBound") == Lines{});
  world.send("S.go", true);
  CHECK(bound(vrml::NodeKind::viewpoint).node == world.scene().get<vrml::MFNode>(group, "children")[4]);
}

}  // namespace gs::app::script_browser_test
