#include "tests/app/script/scripts.h"

#include <algorithm>
#include <fstream>
#include <iterator>

namespace gs::app::contact_browser_test {

using scripts::Lines;
using scripts::run;
using scripts::value;
using scripts::World;

namespace {

vrml::BrowserInput key(vrml::BrowserInputKind kind, int code) {
  vrml::BrowserInput input;
  input.kind = kind;
  input.key = code;
  return input;
}

vrml::NodeChange navigation(World& world) {
  return world.execution().stacks().bound(vrml::built_in_node_type(vrml::NodeKind::navigation_info));
}

/// Returns a world with a Script S that runs `program` for each event of `go`.
std::string on_go(const std::string& program, const std::string& interface = {}) {
  return "DEF S Script { eventIn SFTime go " + interface + " url \"javascript: function go() { " + program + " }\" } ";
}

}  // namespace

TEST_CASE("Browser: answers the time of the world, folders, options and the Script itself (Contact)") {
  World world(
      "DEF S Script { eventIn SFTime go field SFNode me USE S url \"javascript: function go() { "
      "print(Browser.getWorldStartTime() + ' ' + Browser.getTime()); print(Browser.getWorldBaseURL()); "
      "print(Browser.getScript() == me); print(Browser.getOption('a') + '|'); "
      "print(Browser.setOption('a', 7) + Browser.getOption('a')); }\" directOutput TRUE }");
  world.start();
  world.runner().set_browser({"file:///a/b.wrl?c/d", 0, 0});
  world.step(2);
  world.send("S.go", 0.0);
  CHECK(world.printed() == Lines{"1000 1002", "file:///a/", "true", "|", "true7"});
}

TEST_CASE("Browser: stores a bounded number of options") {
  CHECK(value("kept + ' ' + Browser.getOption('o0').length",
              "var kept = 0; for (var i = 0; i < 1000; ++i) if (Browser.setOption('o' + i, new Array(1000).join('x'))) "
              "++kept;") == "64 256");
}

TEST_CASE("Browser: reads and writes sizes, speed and headlight of the bound NavigationInfo (Contact)") {
  World world("DEF N NavigationInfo { avatarSize [ 0.5 2 ] speed 3 visibilityLimit 40 headlight FALSE }" +
              on_go("print(Browser.getCollisionDistance() + ' ' + Browser.getAvatarHeight() + ' ' + "
                    "Browser.getStepOverSize() + ' ' + Browser.getWalkSpeed() + ' ' + Browser.getVisibilityLimit() + "
                    "' ' + Browser.getHeadlight() + ' ' + Browser.getZNear() + ' ' + Browser.getZFar()); "
                    "Browser.setAvatarHeight(4); Browser.setStepOverSize('1'); Browser.setCollisionDistance(-1); "
                    "Browser.setWalkSpeed(NaN); Browser.setVisibilityLimit(8); Browser.setHeadlight(1); "
                    "print(Browser.getAvatarHeight() + ' ' + Browser.getStepOverSize() + Browser.getHeadLight());"));
  world.start();
  (void)world.take();
  world.step(1);
  world.send("S.go", 0.0);
  CHECK(world.printed() == Lines{"0.5 2 0.75 3 40 false 0.25 40", "4 1true"});
  CHECK(world.take() == Lines{"1 N.avatarSize [ 0.5, 4, 1 ]", "1 N.visibilityLimit 8", "1 N.headlight TRUE"});
  CHECK(world.problems() ==
        Lines{"text.wrl:2:95: warning: Script S: sizes and speeds of the viewer are numbers from 0; not set"});
}

TEST_CASE("Browser: makes and binds one NavigationInfo if the world has none") {
  World world(
      on_go("print(Browser.getAvatarHeight().toFixed(1)); Browser.setAvatarHeight(3); "
            "Browser.setWalkSpeed(5); print(Browser.getAvatarHeight());"));
  world.start();
  world.execution().browser().set_view({{640, 480}, "FLY", 2.5});
  for (int i = 1; i <= 5; ++i) {
    world.step(i);
    world.send("S.go", 0.0);
    if (i == 1) CHECK(world.printed() == Lines{"1.6", "3"});
  }
  CHECK(world.printed().back() == "3");
  const vrml::NodeChange made = navigation(world);
  REQUIRE(made.scene);
  CHECK(made.scene->get<vrml::MFFloat>(made.node, "avatarSize")[1] == 3);
  CHECK(made.scene->get<vrml::SFFloat>(made.node, "speed") == 5);
  CHECK(made.scene->get<vrml::MFString>(made.node, "type")[0].view() == "FLY");
  CHECK(world.scene().nodes().count() == 2);  // the Script and one NavigationInfo
  CHECK(world.problems() == Lines{});
}

TEST_CASE("Browser: moves the viewer and tells the bound Viewpoint (Contact)") {
  World world("DEF V Viewpoint { position 1 2 3 }" +
              on_go("var p = new SFVec3f(), r = new SFRotation(); print(Browser.boundViewpoint == v); "
                    "Browser.viewpointPosition = new SFVec3f(4, 5, 6); print(Browser.viewpointPosition); "
                    "Browser.setViewpointByValue(new SFVec3f(7, 8, 9), new SFRotation(0, 1, 0, 1), 1); "
                    "Browser.getViewpointByValue(p, r, 0); print(p + ' ' + r.y + ' ' + r.angle.toFixed(3)); "
                    "Browser.viewpointPosition = new SFVec3f(NaN, 0, 0); print(Browser.viewpointPosition.x);",
                    "field SFNode v USE V"));
  world.start();
  world.step(1);
  world.send("S.go", 0.0);
  CHECK(world.printed() == Lines{"true", "4 5 6", "7 8 9 1 1.000", "7"});
  const auto moved = world.execution().browser().take_move();
  REQUIRE(moved);
  CHECK(glm::dvec3((*moved)[3]) == glm::dvec3(7, 8, 9));
  CHECK_FALSE(world.execution().browser().take_move());
}

TEST_CASE("Browser: tells the size of the window and changes settings (Contact)") {
  World world(
      on_go("print(Browser.getWindowSizeX() + ' ' + Browser.getWindowSizeY() + ' ' + Browser.getWindowAspect() "
            "+ ' ' + Browser.windowAspect + ' ' + Browser.windowSize); Browser.setGravity(false); "
            "Browser.setCollisionDetection(0); Browser.setSoundEnabled(FALSE); "
            "Browser.setViewpointAnimation(false); Browser.setNavigationMode('fly'); "
            "print(Browser.getGravity() || Browser.getCollisionDetection() || Browser.getSoundEnabled() || "
            "Browser.getViewpointAnimation()); print(Browser.getNavigationMode());"));
  world.start();
  world.execution().browser().set_view({{800, 400}, "WALK", 1});
  world.step(1);
  world.send("S.go", 0.0);
  CHECK(world.printed() == Lines{"800 400 2 2 800 400", "false", "FLY"});
  const vrml::BrowserSettings& settings = world.execution().browser().settings();
  CHECK_FALSE((settings.gravity || settings.collision || settings.sound || settings.viewpoint_animation));
  CHECK(world.execution().browser().take_mode() == "FLY");
}

TEST_CASE("Browser: answers unknown methods with undefined and one warning per name") {
  World world(
      "DEF S Script { eventIn SFTime go url \"javascript: function go() { print(Browser.fooBar(1).x); }"
      "function initialize() { for (var i = 0; i < 3; ++i) print(Browser.fooBar(i)); Browser.other(); "
      "print(typeof Browser.fooBar); Browser.mine = function (a) { return a + (this == Browser); }; "
      "print(Browser.mine(1)); }\" }");
  world.start();
  CHECK(world.printed() == Lines{"undefined", "undefined", "undefined", "undefined", "2"});
  CHECK(world.problems() == Lines{"text.wrl:2:7: warning: Script S: Browser has no method 'fooBar'; it does nothing",
                                  "text.wrl:2:7: warning: Script S: Browser has no method 'other'; it does nothing"});
}

TEST_CASE("Browser: accepts any arguments in all of its methods") {
  // replaceWorld, loadURL and others complain about wrong arguments, but nothing fails the engine.
  World world(
      "DEF S Script { directOutput TRUE field SFNode me USE S url \"javascript: function initialize() { var all = "
      "Object.getOwnPropertyNames(Browser), count = 0; var odd = [undefined, null, NaN, -1, 1e300, 'x', me, Browser, "
      "[], {}, function () {}]; for (var i = 0; i < all.length; ++i) { if (typeof Browser[all[i]] != 'function' || "
      "all[i] == 'replaceWorld') continue; ++count; for (var k = 0; k < odd.length; ++k) try { Browser[all[i]](odd[k], "
      "odd[(k + 3) % odd.length], odd[(k + 7) % odd.length], odd[k]); } catch (e) {} try { Browser[all[i]](); } catch "
      "(e) {} } print(count > 80); for (var k = 0; k < odd.length; ++k) for (var i = 0; i < all.length; ++i) if "
      "(typeof Browser[all[i]] != 'function') try { Browser[all[i]] = odd[k]; } catch (e) {} }\" }");
  world.start();
  world.step(1);
  const Lines printed = world.printed();
  REQUIRE_FALSE(printed.empty());
  CHECK(printed.back() == "true");
  for (const std::string& problem : world.problems()) CHECK(problem.find("error: Script S") == std::string::npos);
}

TEST_CASE("the manual lists every method and property of the Browser object") {
  World world(
      "DEF S Script { url \"javascript: function initialize() { print(Object.getOwnPropertyNames(Browser)"
      ".join(' ')); }\" }");
  world.start();
  const Lines printed = world.printed();
  REQUIRE(printed.size() == 1);
  std::ifstream file(std::string(GHOSTSPACE_TESTS) + "/../docs/manual.md");
  const std::string manual{std::istreambuf_iterator<char>(file), {}};
  REQUIRE_FALSE(manual.empty());
  for (std::size_t at = 0; at < printed[0].size();) {
    const std::size_t end = std::min(printed[0].size(), printed[0].find(' ', at));
    const std::string name = printed[0].substr(at, end - at);
    INFO(name);
    CHECK(manual.find('`' + name + '`') != std::string::npos);
    at = end + 1;
  }
}

TEST_CASE("addRoute and deleteRoute take the Browser as a node") {
  World world(
      "DEF S Script { eventIn SFTime go eventIn SFTime stop eventIn SFFloat aspect eventIn SFVec3f place "
      "eventOut SFVec3f moved field SFNode me USE S url \"javascript: function go() { "
      "Browser.addRoute(Browser, 'windowAspect', me, 'aspect'); "
      "Browser.addRoute(Browser, 'viewpointPosition_changed', me, 'place'); "
      "Browser.addRoute(me, 'moved', Browser, 'set_viewpointPosition'); moved = new SFVec3f(3, 2, 1); "
      "try { Browser.addRoute(Browser, 'nothing', me, 'aspect'); } catch (e) { print(e.message); } "
      "try { Browser.addRoute(Browser, 'windowAspect', Browser, 'windowAspect'); } catch (e) { print('no'); } }"
      "function stop() { Browser.deleteRoute(Browser, 'windowAspect', me, 'aspect'); }"
      "function aspect(a) { print('aspect ' + a); } function place(p) { print('place ' + p); }\" }");
  world.start();
  world.execution().browser().set_view({{300, 200}, "WALK", 1});
  world.step(1);
  world.send("S.go", 0.0);
  CHECK(world.printed() == Lines{"no eventOut 'nothing'", "no", "place 3 2 1"});
  const auto moved = world.execution().browser().take_move();
  REQUIRE(moved);
  CHECK(glm::dvec3((*moved)[3]) == glm::dvec3(3, 2, 1));
  world.execution().viewer().set(*moved);
  world.step(2);
  // The position has the value that the ROUTE to the Browser has set, so it has not changed.
  CHECK(world.printed() == Lines{"aspect 1.5"});
  world.execution().browser().set_view({{400, 200}, "WALK", 1});
  world.step(3);
  CHECK(world.printed() == Lines{"aspect 2"});
  world.send("S.stop", 0.0);
  world.execution().browser().set_view({{500, 200}, "WALK", 1});
  world.step(4);
  CHECK(world.printed() == Lines{});
  CHECK(world.problems() == Lines{});
}

TEST_CASE("event_changed sends keys and buttons by eventMask, and a program can cancel them (Contact)") {
  World world(
      "DEF S Script { eventIn SFNode onEvent field SFNode me USE S url \"javascript: function initialize() { "
      "Browser.eventMask = Browser.eventMask | (1 << 4) | (1 << 5); "
      "Browser.addRoute(Browser, 'event_changed', me, 'onEvent'); } function onEvent(e) { print(e.type + ' ' + "
      "e.keyCode + ' ' + e.button + ' ' + (e.shiftKey == 1) + ' ' + e.client + ' ' + "
      "Browser.isKeyPressed(68)); if (e.keyCode == 68) e.returnValue = 0; }\" directOutput TRUE }");
  world.start();
  vrml::WorldBrowser& browser = world.execution().browser();
  world.step(1);
  using Kind = vrml::BrowserInputKind;
  CHECK(browser.send_input(key(Kind::keydown, 68)));
  CHECK_FALSE(browser.send_input(key(Kind::keyup, 68)));  // not in the mask
  vrml::BrowserInput button{Kind::mouseup, 0, 2, false, false, true, {3, 4}};
  CHECK_FALSE(browser.send_input(button));
  CHECK(world.printed() == Lines{"keydown 68 0 false 0 0 true", "mouseup 0 2 true 3 4 false"});
  CHECK(world.problems() == Lines{});
}

TEST_CASE("stops programs that call the Browser endlessly, and runs the world on") {
  for (const std::string program :
       {"for (var i = 0; i < 3000; ++i) { Browser.addRoute(Browser, 'windowAspect', me, 'aspect'); "
        "Browser.deleteRoute(Browser, 'windowAspect', me, 'aspect'); }",
        "for (var i = 0; i < 3000; ++i) { Browser.setAvatarHeight(i); Browser.setNavigationMode('x' + i); }",
        "for (var i = 0; i < 3000; ++i) { Browser.viewpointPosition = new SFVec3f(i, 0, 0); Browser.setOption('a' + i, "
        "i); }",
        "for (var i = 0; i < 3000; ++i) Browser.computeRayHit(new SFVec3f(0, 0, 9), new SFVec3f(0, 0, -9));",
        "var q = String.fromCharCode(34); for (var i = 0; i < 50; ++i) Browser.createVrmlFromString('DEF S Script { "
        "eventIn SFFloat a url ' + q + 'javascript: function a() { }' + q + ' } ROUTE Browser.windowAspect TO S.a');",
        "Browser.replaceWorld(Browser.createVrmlFromString('Group { }')); Browser.setAvatarHeight(3); "
        "Browser.addRoute(Browser, 'event_changed', me, 'ev');"}) {
    INFO(program);
    World world(
        "DEF C TimeSensor { loop TRUE } DEF S Script { directOutput TRUE field SFNode me USE S eventIn SFTime "
        "tick eventIn SFFloat aspect eventIn SFNode ev url \"javascript: function tick(t) { " +
        program + " } function aspect() { } function ev() { }\" } ROUTE C.time TO S.tick");
    world.start();
    std::size_t most_nodes = 0;
    for (int i = 1; i <= 30; ++i) {
      world.execution().browser().set_view({{100.0 + i, 100}, "WALK", 1});
      world.step(i * 0.1);
      (void)world.execution().browser().send_input(key(vrml::BrowserInputKind::keydown, 65));
      most_nodes = std::max(most_nodes, world.scene().nodes().count());
    }
    CHECK(most_nodes < 12'000);
  }
}

}  // namespace gs::app::contact_browser_test
