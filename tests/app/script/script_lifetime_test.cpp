#include "scripts.h"

#include "app/base/text_source.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

// Tests of values, jobs and nodes that outlive their Script or scene.
namespace gs::app::script_lifetime_test {

using scripts::Lines;
using scripts::run;
using scripts::World;

namespace {

/// Attaches another scene to the first node of the world, an Inline.
vrml::SceneGraph& fill_inline(World& world, const std::string& body) {
  const vrml::NodeId inline_node = world.scene().roots()[0];
  auto content = std::make_shared<vrml::SceneGraph>("inner.wrl", world.scene().budget());
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\n" + body, *content, diagnostics);
  CHECK(diagnostics.errors() == 0);
  content->set_source(world.scene().source());
  world.execution().lifetime().remove_content(world.scene(), inline_node);
  world.scene().inlines().attach(inline_node, content);
  world.execution().scenes().attach(world.scene());
  world.execution().changes().mark_content(world.scene(), inline_node);
  return *content;
}

}  // namespace

TEST_CASE("shutdown() of a removed Inline creates no nodes, and extends no list that is being read") {
  World world("Inline { }");
  world.start();
  fill_inline(
      world,
      "Script { url \"javascript: function shutdown() { try { var text = ''; for (var i = 0; i < 400; ++i) text "
      "+= 'Script { } '; Browser.createVrmlFromString(text); } catch (e) { print(e.message); } }\" } Script { "
      "url \"javascript: function shutdown() { print('second'); Browser.loadURL('x.wrl'); }\" }");
  world.step(1);
  fill_inline(world, "Group { }");
  world.step(2);
  CHECK(world.printed() == Lines{"shutdown() cannot create nodes", "second"});
  CHECK(world.runner().take_requests().empty());
}

TEST_CASE("refuses values that contain themselves, and 200,000 nested arrays, without deep recursion") {
  const std::string types[] = {"SFVec3f", "SFVec2f", "SFColor", "SFRotation", "SFNode",
                               "MFVec3f", "MFNode",  "MFColor", "MFRotation"};
  for (const std::string& type : types)
    for (const char* const make : {"var a = []; a[0] = a;", "var a = []; for (var i = 0; i < 200000; ++i) a = [a];"}) {
      INFO(type << " " << make);
      World world("DEF S Script { eventOut " + type + " v url \"javascript: function initialize() { " + make +
                  " try { v = a; print('set'); } catch (e) { print('refused'); } print('goes on'); }\" }");
      world.start();
      const Lines printed = world.printed();
      REQUIRE(printed.size() == 2);
      CHECK(printed[1] == "goes on");
    }
  for (const char* const call : {"Browser.loadURL(a, a)", "Browser.replaceWorld(a)",
                                 "Browser.createVrmlFromURL(a, me, 'x')", "new MFVec3f(a)", "new SFVec3f(a, a, a)"})
    CHECK(run(std::string("var a = []; a[0] = a; try { ") + call + "; } catch (e) { } print('goes on');",
              "field SFNode me USE S") == Lines{"goes on"});
}

TEST_CASE("treats a list of one tuple and an array of numbers as tuples") {
  CHECK(run("v = [1, 2, 3]; print(v); v = [[4, 5, 6]]; print(v); v = new MFVec3f(new SFVec3f(7, 8, 9)); print(v); v = "
            "[new SFVec3f(1, 1, 1)]; print(v);",
            "eventOut SFVec3f v") == Lines{"1 2 3", "4 5 6", "7 8 9", "1 1 1"});
}

TEST_CASE("runs promise jobs after an exception, in the turn and the world that made them") {
  World first(
      "DEF S Script { eventIn SFBool go url \"javascript: function initialize() { Promise.resolve().then(function() { "
      "print('job'); }); throw new Error('x'); } function go() { for (var i = 0; i < 3; ++i) "
      "Promise.resolve(i).then(function(v) { print('job ' + v); throw 1; }).then(null, function(e) { print('caught ' + "
      "e); }); print('go'); }\" }");
  first.start();
  CHECK(first.printed() == Lines{"job"});
  CHECK(first.problems().size() == 1);
  World second("Script { url \"javascript: function initialize() { print('second'); }\" }");
  second.start();
  CHECK(second.printed() == Lines{"second"});
  first.send_at(1, "S.go", true);
  CHECK(first.printed() == Lines{"go", "job 0", "job 1", "job 2", "caught 1", "caught 1", "caught 1"});
}

TEST_CASE("discards promise jobs of a Script that was stopped") {
  Limits limits;
  limits.script_seconds = 0.1;
  auto first = std::make_unique<World>(
      "Script { url \"javascript: function initialize() { Promise.resolve().then(function() { print('never'); }); "
      "while (true); }\" }",
      limits);
  first->start();
  CHECK(first->printed() == Lines{});
  first->end();
  first.reset();
  World second(
      "Script { url \"javascript: function initialize() { Promise.resolve().then(function() { "
      "print('second'); }); }\" }");
  second.start();
  CHECK(second.printed() == Lines{"second"});
}

TEST_CASE("stops endless promise jobs like any program") {
  Limits limits;
  limits.script_seconds = 0.1;
  World world(
      "Script { url \"javascript: function initialize() { function again() { Promise.resolve().then(again); } again(); "
      "}\" }",
      limits);
  world.start();
  const Lines problems = world.problems();
  REQUIRE(problems.size() == 1);
  CHECK(problems[0].find("exceeded the time limit") != std::string::npos);
}

TEST_CASE("stops an endless getter named eventsProcessed") {
  Limits limits;
  limits.script_seconds = 0.1;
  World world(
      "Script { url \"javascript: Object.defineProperty(this, 'eventsProcessed', { get: function() { while (true); } "
      "});\" }",
      limits);
  world.start();
  CHECK(world.problems().size() == 1);
}

TEST_CASE("empties the list of a removed Script, and keeps its type") {
  World world(
      "DEF A Script { exposedField MFString url [ ] field MFVec3f points [ 1 2 3 ] field MFNode nodes [ ] } "
      "DEF S Script { directOutput TRUE field SFNode a USE A field MFVec3f points [ 1 2 3, 4 5 6 ] field MFInt32 "
      "numbers "
      "7 eventIn SFBool end url \"javascript: function initialize() { Browser.lists = [points, "
      "numbers]; } \" } DEF B Script { directOutput TRUE field SFNode s USE S eventIn SFBool end eventIn SFBool look "
      "url "
      "\"javascript: function end() { s.url = new MFString('javascript: ;'); } function look() { "
      "print(Browser.lists[0].length "
      "+ ' ' + Browser.lists[0][0] + ' ' + Browser.lists[1][0]); Browser.lists[0][1] = new SFVec3f(1, 1, 1); "
      "print(Browser.lists[0]); var i = new SFImage(1, 1, 1, new MFInt32(5)); i.array = Browser.lists[1]; print(i.x); "
      "}\" }");
  world.start();
  world.send_at(1, "B.end", true);
  world.send_at(2, "B.look", true);
  CHECK(world.printed() == Lines{"0 0 0 0 undefined", "[ 0 0 0, 1 1 1 ]", "1"});
  CHECK(world.problems() == Lines{});
}

TEST_CASE("distinguishes nodes of different scenes with equal numbers") {
  World world(
      "Inline { } DEF T Transform { translation 1 2 3 } DEF S Script { field SFNode t USE T eventIn SFBool look url "
      "\"javascript: function initialize() { Browser.t = t; } function look() { print(Browser.inner == t); "
      "print(Browser.inner.translation); Browser.inner.translation = new SFVec3f(0, 0, 5); }\" directOutput TRUE }");
  world.start();
  const vrml::SceneGraph& inner = fill_inline(
      world,
      "Group { } DEF T Transform { translation 7 8 9 } Script { field SFNode t USE T url \"javascript: function "
      "initialize() { Browser.inner = t; print(Browser.t == t); }\" }");
  world.send_at(1, "S.look", true);
  CHECK(world.printed() == Lines{"false", "false", "7 8 9"});
  CHECK(inner.get<vrml::SFVec3f>(inner.roots()[1], "translation") == vrml::SFVec3f(0, 0, 5));
  CHECK(world.scene().get<vrml::SFVec3f>(world.scene().roots()[1], "translation") == vrml::SFVec3f(1, 2, 3));
}

TEST_CASE("rejects a node of a removed scene in the scene that replaces it") {
  World world(
      "Inline { } DEF S Script { eventIn SFBool look url \"javascript: function look() { "
      "print(Browser.inner.translation "
      "+ ' ' + Browser.list[0]); Browser.inner.translation = new SFVec3f(0, 0, 5); }\" directOutput TRUE }");
  world.start();
  const std::string keeps =
      " Script { field SFNode t USE T field MFNode l USE T url \"javascript: function initialize() { Browser.inner = "
      "t; Browser.list = l; }\" }";
  fill_inline(world, "DEF T Transform { translation 7 8 9 }" + keeps);
  world.step(1);
  for (int i = 0; i < 20; ++i) {
    const vrml::SceneGraph& inner = fill_inline(world, "DEF T Transform { translation 1 1 1 }");
    world.send_at(2 + i, "S.look", true);
    CHECK(inner.get<vrml::SFVec3f>(inner.roots()[0], "translation") == vrml::SFVec3f(1, 1, 1));
  }
  for (const std::string& line : world.printed()) CHECK(line == "undefined null");
}

TEST_CASE("keeps the faults of a Script that replaces its own program") {
  Limits limits;
  limits.script_seconds = 0.05;
  World world(
      "DEF S Script { directOutput TRUE field SFNode me USE S eventIn SFTime tick url \"javascript: function tick() { "
      "print('tick'); me.url = me.url; while (true); }\" }",
      limits);
  world.start();
  for (int i = 1; i < 8; ++i) {
    world.send_at(i, "S.tick", 1000.0 + i);
  }
  CHECK(world.printed().size() == 3);
}

TEST_CASE("keeps the element type of a Script's list after the Script's Inline is removed") {
  World world(
      "Inline { } DEF S Script { eventIn SFBool look url \"javascript: function look() { var l = Browser.kept[0]; "
      "print(l.length + ' ' + l[0]); l[0] = new SFVec3f(1, 2, 3); print(l); }\" }");
  world.start();
  fill_inline(world,
              "Script { field MFVec3f mine [ 7 8 9 ] url \"javascript: function initialize() { Browser.kept = "
              "[mine]; }\" }");
  world.step(1);
  fill_inline(world, "Group { }");
  world.send_at(2, "S.look", true);
  CHECK(world.printed() == Lines{"0 0 0 0", "[ 1 2 3 ]"});
}

TEST_CASE("gives nodes and lists without a prototype only their own properties") {
  CHECK(run("[me, mine, new MFVec3f()].forEach(function(x) { Object.setPrototypeOf(x, null); print(x.none + ' ' + "
            "('none' "
            "in x) + ' ' + Object.getOwnPropertyDescriptor(x, 'none')); }); print(mine.length + ' ' + me.mine.length);",
            "field SFNode me USE S field MFNode mine [ ]") ==
        Lines{"undefined false undefined", "undefined false undefined", "undefined false undefined", "0 0"});
}

TEST_CASE("drops requests of a removed scene") {
  World world("Inline { }");
  world.execution().lifetime().observe_removal([&](vrml::SceneGraph& scene, vrml::NodeId node) {
    if (!node) world.runner().forget_scene(scene);
  });
  world.start();
  fill_inline(world,
              "DEF S Script { field SFNode me USE S eventIn MFNode came url \"javascript: function initialize() "
              "{ Browser.createVrmlFromURL('x.wrl', me, 'came'); }\" }");
  world.step(1);
  fill_inline(world, "Group { }");
  CHECK(world.runner().take_requests().empty());
}

}  // namespace gs::app::script_lifetime_test
