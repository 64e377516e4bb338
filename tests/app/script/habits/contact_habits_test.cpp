#include "app/script/habits/contact_habits.h"

#include "tests/app/script/scripts.h"

namespace gs::app::script::contact_habits_test {

using scripts::Lines;
using scripts::run;
using scripts::World;

namespace {

std::string rewritten(const std::string& text, const std::vector<std::string>& exposed = {}) {
  return contact_text(text, exposed, [](std::string_view name) { return name == "known"; });
}

}  // namespace

TEST_CASE("rewrites calls of unknown Browser methods only") {
  CHECK(rewritten("Browser.known(1); Browser.x; Browser.foo(1);") ==
        "Browser.known(1); Browser.x; $browser(\"foo\").foo(1);");
  CHECK(rewritten("a.Browser.foo(); 'Browser.foo()'; // Browser.foo()") ==
        "a.Browser.foo(); 'Browser.foo()'; // Browser.foo()");
}

TEST_CASE("gives the handler of an exposedField another name") {
  CHECK(rewritten("function x(v) { x = v; } function y() { x(1); o.x(2); }", {"x"}) ==
        "function $on_x(v) { x = v; } function y() { $on_x(1); o.x(2); }");
  CHECK(rewritten("var x = 1; x(2);", {"x"}) == "var x = 1; x(2);");
}

TEST_CASE("finds names that a program reads without declaring them") {
  const UndeclaredNames names(
      "var a = 1, b; function f(c) { d = a + c + o.e; if (typeof g == 'undefined') h(); var i = { k: l }; return i; }");
  for (const char* const name : {"c", "d", "o", "g", "i", "l"}) CHECK(names.contains(name));
  for (const char* const name : {"a", "b", "f", "e", "h", "k"}) CHECK_FALSE(names.contains(name));
  CHECK(names.is_tested("g"));
  CHECK_FALSE(names.is_tested("d"));
}

TEST_CASE("holds a bounded number of names, also of a broken program") {
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += "n" + std::to_string(i) + ";";
  const UndeclaredNames names(text);
  int held = 0;
  for (int i = 0; i < 100'000; ++i) held += names.contains("n" + std::to_string(i)) ? 1 : 0;
  CHECK(held <= static_cast<int>(UndeclaredNames::kMaxNames));
  CHECK(UndeclaredNames("function f( { { [ function (").contains("f") == false);
  CHECK(UndeclaredNames("").contains("") == false);
}

TEST_CASE("reads an undeclared name as undefined, with one warning (Contact)") {
  World world(
      "DEF S Script { eventIn SFBool go url \"javascript: function go() { if (v) { print('no'); } print(v + ' ' + "
      "other); v = 3; print(v); } function handler(v) { print(v); } function initialize() { handler(2); "
      "if (typeof known == 'undefined') print('unknown'); print(count++); count = 5; ++count; print(count); }\" }");
  world.start();
  world.step(1);
  world.send("S.go", true);
  CHECK(world.printed() == Lines{"2", "unknown", "NaN", "6", "undefined undefined", "3"});
  Lines problems = world.problems();
  for (std::string& problem : problems) problem = problem.substr(problem.find("warning: "));
  CHECK(problems == Lines{"warning: Script S: reads 'count', which is not declared; it is undefined",
                          "warning: Script S: reads 'v', which is not declared; it is undefined",
                          "warning: Script S: reads 'other', which is not declared; it is undefined"});
}

TEST_CASE("still reports the call of a function that does not exist, and the program goes on") {
  World world("DEF S Script { eventIn SFBool go url \"javascript: function go() { print('goes on'); missing(1); }\" }");
  world.start();
  world.step(1);
  world.send("S.go", true);
  CHECK(world.printed() == Lines{"goes on"});
  REQUIRE(world.problems().size() == 1);
}

TEST_CASE("keeps variables, functions and standard objects of a program as they are") {
  CHECK(run("print(typeof later); print(typeof Math + typeof SFVec3f + typeof print); a = b = 2; print(a + b); "
            "print('a' in this); for (var later in { k: 1 }) print(later);") ==
        Lines{"undefined", "objectfunctionfunction", "4", "true", "k"});
}

TEST_CASE("calls function x for events of an exposedField x, which keeps its value (Contact)") {
  World world(
      "DEF S Script { exposedField SFFloat x 1 eventIn SFTime go url \"javascript: function x(v, t) { print('x ' + v + "
      "' ' + x + ' ' + t); } function go() { x = 5; x(7, 8); }\" }");
  world.start();
  world.step(1);
  world.send("S.x", 2.5f);
  world.step(2);
  world.send("S.go", 0.0);
  CHECK(world.printed() == Lines{"x 2.5 2.5 1001", "x 7 5 8"});
  CHECK(world.take("S.x") == Lines{"1 S.x 2.5", "2 S.x 5"});
  CHECK(world.problems() == Lines{});
}

TEST_CASE("shows children at once after addChildren and removeChildren") {
  World world(
      "DEF A Group {} DEF B Group {} DEF G Group { children USE A } DEF S Script { directOutput TRUE field SFNode g "
      "USE "
      "G field SFNode a USE A field SFNode b USE B url \"javascript: function initialize() { print(g.children.length); "
      "g.addChildren = new MFNode(b); print(g.children.length + ' ' + (g.children[1] == b)); g.addChildren = new "
      "MFNode(b, a); print(g.children.length); g.removeChildren = new MFNode(a); print(g.children.length + ' ' + "
      "(g.children[0] == b)); g.children = new MFNode(); print(g.children.length); }\" }");
  world.start();
  CHECK(world.printed() == Lines{"1", "2 true", "2", "1 true", "0"});
  CHECK(world.scene().get<vrml::MFNode>(world.node("G"), "children").empty());
  CHECK(world.problems() == Lines{});
}

TEST_CASE("shows children after many stored events in bounded time") {
  World world(
      "DEF A Group {} DEF G Group { } DEF S Script { directOutput TRUE field SFNode g USE G field SFNode a USE A url "
      "\"javascript: function initialize() { for (var i = 0; i < 2000; ++i) { g.addChildren = new MFNode(a); "
      "g.removeChildren = new MFNode(a); } print(g.children.length); }\" }");
  world.start();
  CHECK(world.printed() == Lines{"0"});
}

}  // namespace gs::app::script::contact_habits_test
