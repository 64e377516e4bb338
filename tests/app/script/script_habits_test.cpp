#include "scripts.h"

namespace gs::app::script_habits_test {

using scripts::Lines;
using scripts::run;
using scripts::value;
using scripts::World;

// Tests of programs from the time of VRML97 that use no standard.

TEST_CASE("calls constructors also without new") {
  CHECK(value("SFVec3f(1, 2, 3).add(SFVec3f(1, 1, 1)) + ' ' + SFColor(1) + ' ' + SFRotation(0, 0, 1, 2) + ' ' + "
              "MFInt32(1, 2)") == "2 3 4 1 0 0 0 0 1 2 [ 1, 2 ]");
  CHECK(value("SFFloat(2.5) + SFInt32(2.5) + SFTime(1) + ' ' + SFBool(0) + ' ' + SFString('a')") == "5.5 false a");
  CHECK(value("new SFFloat(2.5) + new SFInt32(2.5)") == "4.5");
  CHECK(run("b = new SFBool(FALSE); print(b); f = new SFFloat(3); print(f);", "eventOut SFBool b eventOut SFFloat f") ==
        Lines{"false", "3"});
}

TEST_CASE("keeps names without var inside their own Script") {
  World world(
      "DEF A Script { url \"javascript: function initialize() { count = 1; }\" }"
      "DEF B Script { url \"javascript: function initialize() { print(typeof count); }\" }");
  world.start();
  CHECK(world.printed() == Lines{"undefined"});
}

TEST_CASE("accepts numbers in parseInt") {
  CHECK(value("parseInt(0.0000005) + ' ' + parseInt(-3.7) + ' ' + parseInt('12px') + ' ' + parseInt('ff', 16)") ==
        "0 -3 12 255");
}

TEST_CASE("accepts vrmlscript and other spellings of the schemes, with print, trace and alert") {
  World world("Script { url \"VrmlScript: print('a'); trace('b', 1); alert('c'); Browser.println('d');\" }");
  world.start();
  CHECK(world.printed() == Lines{"a", "b 1", "c", "d"});
}

TEST_CASE("accepts multi-line strings, names that are reserved today, and comments of VRML and HTML") {
  World world(
      "DEF S Script { url \"javascript:\n<!-- for old browsers\nvar class = 'a\nb';\n# of VRML\nvar enum = 1;\n"
      "function initialize() { print(class.length + enum); }\n}\n// -->\n\" }");
  world.start();
  CHECK(world.problems() == Lines{});
  CHECK(world.printed() == Lines{"4"});
}

TEST_CASE("accepts for each, functions without braces, open comments, toSource and uneval of JavaScript 1.x") {
  const auto printed = [](const std::string& program) {
    World world("DEF S Script { field MFInt32 list [ 7, 8 ] url \"javascript: " + program + "\" }");
    world.start();
    CHECK(world.problems() == Lines{});
    return world.printed();
  };
  CHECK(printed(
            "function initialize() { var o = { a: 1, b: 2 }; for each (var v in o) print(v); for each (v in list) { "
            "print(v); } var s = 'x'; for each(v in [[3][0], s]) print(v); }") == Lines{"1", "2", "7", "8", "3", "x"});
  CHECK(printed("var twice = function (x) x * 2; function add(a, b) a + (b, b);\n"
                "function initialize() { print(twice(2), add(1, 2)); print([1, 2].map(function (x) x + 1)); }") ==
        Lines{"4 3", "2,3"});
  CHECK(printed("function initialize() { print('runs'); } /* and so on") == Lines{"runs"});
  CHECK(printed("function initialize() { print([1].toSource() + uneval('a').length); }") == Lines{"[1]3"});
  // A word that has a meaning in ECMAScript today stays unchanged.
  CHECK(printed("var each = 2; function initialize() { for (var each in { k: 1 }) print(each); }") == Lines{"k"});
}

TEST_CASE("adds a missing brace at the end") {
  World world("DEF S Script { url \"javascript: function initialize() { print('runs');\" }");
  world.start();
  CHECK(world.printed() == Lines{"runs"});
}

TEST_CASE("binds Viewpoints by bind, and reads fields of nodes") {
  World world(
      "DEF A Viewpoint {} DEF B Viewpoint {} DEF X Box { size 1 2 3 } DEF S Script { directOutput TRUE field SFNode v "
      "USE B "
      "field SFNode b USE X eventIn SFBool go url \"javascript: function go() { v.bind = TRUE; print(b.size); }\" }");
  world.start();
  world.send_at(1, "S.go", true);
  CHECK(world.take("B.isBound") == Lines{"1 B.isBound TRUE"});
  CHECK(world.printed() == Lines{"1 2 3"});
}

TEST_CASE("ignores an unknown field of a node, with one warning") {
  World world(
      "DEF T Transform {} DEF S Script { directOutput TRUE field SFNode t USE T url \"javascript: function "
      "initialize() { t.nothing = 1; t.nothing = 2; print(t.nothing); }\" }");
  world.start();
  CHECK(world.printed() == Lines{"undefined"});
  CHECK(world.problems() == Lines{"text.wrl:2:26: warning: Script S: Transform has no eventIn 'nothing'; not set"});
}

TEST_CASE("assigns a part of a node's value") {
  World world(
      "DEF T Transform {} DEF C Coordinate { point [ 0 0 0, 1 1 1 ] } DEF S Script { directOutput TRUE field SFNode t "
      "USE T field SFNode c USE C url \"javascript: function initialize() { t.translation.y = 2; "
      "c.point[1] = new SFVec3f(5, 5, 5); c.point[0].x = 3; }\" }");
  world.start();
  CHECK(world.take() == Lines{"0 T.translation 0 2 0", "0 C.point [ 3 0 0, 5 5 5 ]"});
}

TEST_CASE("answers methods of other browsers without effect") {
  CHECK(
      run("Browser.showConsole(); Browser.beginUpdate(); Browser.setCollisionDetection(TRUE); print(Browser.getTime());"
          "print(Browser.viewpointPosition); print(Browser.getBrowserOption('x')); Browser.endUpdate();") ==
      Lines{"1000", "0 0 10", "0"});
}

TEST_CASE("accepts one value for a list, and arrays for lists") {
  CHECK(run("m = 'one'; print(m); m = ['a', 'b']; print(m); i = [1, 2.5]; print(i); v = [1, 2, 3]; print(v);",
            "field MFString m [] field MFInt32 i [] field SFVec3f v 0 0 0") ==
        Lines{"[ \"one\" ]", "[ \"a\", \"b\" ]", "[ 1, 2 ]", "1 2 3"});
}

TEST_CASE("reports a Java program once, and runs the world on") {
  World world("DEF S Script { url \"Applet.class\" } DEF T Script { url \"javascript: print('on');\" }");
  world.start();
  CHECK(world.problems() == Lines{"text.wrl:2:7: warning: Script S: Java programs are not supported; skipped"});
  CHECK(world.printed() == Lines{"on"});
}

TEST_CASE("reports a program in another browser's language, and tries the next url") {
  World world("DEF S Script { url [ \"castlescript: x\" \"javascript: print('on');\" ] }");
  world.start();
  CHECK(world.problems() == Lines{"text.wrl:2:7: warning: Script S: programs in 'castlescript' are not supported; skipped"});
  CHECK(world.printed() == Lines{"on"});
}

}  // namespace gs::app::script_habits_test
