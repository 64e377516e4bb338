#include "app/base/exit_status.h"
#include "app/simulation/input_rows.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::trace_test {
namespace {

std::string complaint(const std::string& text) {
  Diagnostics diagnostics;
  (void)read_input_rows(text, "in.jsonl", diagnostics);
  return diagnostics.entries().empty() ? std::string() : diagnostics.entries().front().text();
}

const std::string kWorld = R"(#VRML V2.0 utf8
DEF V1 Viewpoint { description "Front" } DEF V2 Viewpoint { description "Back" position 0 0 -10 orientation 0 1 0 3.14159 }
DEF Clock TimeSensor { cycleInterval 0.1 startTime 946684800.05 }
DEF Path PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 2 0 0 ] }
DEF Place Transform { children Shape { geometry Box { } appearance Appearance { material Material { } } } }
Transform { }
ROUTE Clock.fraction_changed TO Path.set_fraction ROUTE Path.value_changed TO Place.translation
)";

const std::string kSensors = R"(#VRML V2.0 utf8
Viewpoint { fieldOfView 1.5707963 }
PROTO Button [ field SFVec3f at 0 0 0 ] { Transform { translation IS at children [ Shape { geometry Box { } } ] } }
Group { children [ Button { at 0 0 -1 } DEF T TouchSensor { } ] }
Transform { translation -4 0 0 children [ Shape { geometry Box { } } DEF P PlaneSensor { maxPosition 1 1 } ] }
Transform { translation 4 0 -1 children [ Shape { geometry Sphere { radius 2 } } DEF S SphereSensor { } ] }
Transform { translation 0 5 -1 children [ Shape { geometry Cylinder { radius 2 } } DEF C CylinderSensor { } ] }
DEF A Anchor { url "x" children Transform { translation 0 -5 0 children Shape { geometry Box { } } } }
)";

// Returns the lines of a trace after the first two, which bind the Viewpoint.
std::string pointed(const std::string& world, const std::string& arguments, const std::string& rows) {
  const ScratchFolder folder;
  const std::string file = folder.write("world.wrl", world), input = folder.write("in.jsonl", rows);
  const Run result = run("trace " + quoted(file) + " --until 2 " + arguments + " --input " + quoted(input));
  CHECK(result.status == kDone);
  const std::string bound = "946684800 Viewpoint#1.isBound TRUE\n946684800 Viewpoint#1.bindTime 946684800\n";
  return result.output.starts_with(bound) ? result.output.substr(bound.size()) : result.output;
}

}  // namespace

TEST_CASE("reads the lines of --input, and reports errors with their positions") {
  Diagnostics diagnostics;
  const auto rows = read_input_rows(
      "{\"t\":0,\"viewpoint\":\"Back\"}\n\n{\"t\":1.5,\"set\":\"A.b.set_x\",\"value\":\"1 0 0\"}\r\n"
      "{\"t\":2,\"set\":\"A.on\",\"value\":true}\n{\"t\":2,\"set\":\"A.n\",\"value\":-2}\n"
      "{\"t\":2,\"move\":[1,2.5]}\n{\"t\":2,\"press\":[-3,4]}\n{\"t\":2,\"release\":[0,0]}\n"
      "{\"t\":3,\"press\":\"T\"}\n{\"t\":3,\"drag\":[5,-6]}\n{\"t\":3,\"release\":true}\n{\"t\":3,\"viewer\":[1,2,3]}",
      "in.jsonl", diagnostics);
  CHECK(diagnostics.errors() == 0);
  REQUIRE(rows.size() == 11);
  CHECK(rows[0].kind == InputRow::Kind::viewpoint);
  CHECK(rows[0].name == "Back");
  CHECK(rows[1].time == 1.5);
  CHECK(rows[1].name == "A.b");
  CHECK(rows[1].event == "set_x");
  CHECK(rows[1].location.line == 3);
  CHECK(rows[2].value == "TRUE");
  CHECK(rows[3].value == "-2");
  CHECK(rows[4].kind == InputRow::Kind::move);
  CHECK(rows[4].pointer == glm::dvec2(1, 2.5));
  CHECK(rows[5].kind == InputRow::Kind::press);
  CHECK(rows[5].pointer == glm::dvec2(-3, 4));
  CHECK(rows[6].kind == InputRow::Kind::release);
  CHECK(rows[7].kind == InputRow::Kind::press_sensor);
  CHECK(rows[7].name == "T");
  CHECK(rows[8].kind == InputRow::Kind::drag_sensor);
  CHECK(rows[8].pointer == glm::dvec2(5, -6));
  CHECK(rows[9].kind == InputRow::Kind::release_sensor);
  CHECK(rows[10].kind == InputRow::Kind::visit);
  CHECK(rows[10].place == glm::dvec3(1, 2, 3));

  const std::string expected =
      "expected one of \"set\", \"viewpoint\", \"move\", \"press\", \"release\", "
      "\"drag\", \"key\" and \"viewer\"";
  CHECK(complaint("{\"t\":1}\n{\"t\":") == "in.jsonl:1:1: error: " + expected);
  CHECK(complaint("{\"t\":1,\"move\":[1,2],\"press\":[1,2]}") == "in.jsonl:1:1: error: " + expected);
  CHECK(complaint("\n{\"t\":1,") == "in.jsonl:2:8: error: not JSON");
  CHECK(complaint("[1]") == "in.jsonl:1:1: error: expected a JSON object");
  CHECK(complaint("{\"t\":-1,\"viewpoint\":\"A\"}").find("in.jsonl:1:2: error: expected \"t\"") == 0);
  CHECK(complaint("{\"t\":1e999,\"viewpoint\":\"A\"}") == "in.jsonl:1:1: error: a number is too large");
  CHECK(complaint("{\"t\":2,\"viewpoint\":\"A\"}\n{\"t\":1,\"viewpoint\":\"A\"}") ==
        "in.jsonl:2:2: error: lines must be in the order of time");
  const std::string pixels =
      "in.jsonl:1:8: error: expected \"press\": [X,Y] in pixels from the upper left corner, or the name of a sensor";
  for (const char* place : {"[1]", "[1,2,3]", "1", "[1,\"2\"]", "[1,1e99]", "{}"})
    CHECK(complaint("{\"t\":1,\"press\":" + std::string(place) + "}") == pixels);
  CHECK(complaint("{\"t\":1,\"key\":\"hyper\",\"down\":true}") ==
        "in.jsonl:1:8: error: expected \"key\": the name of a key");
  CHECK(complaint("{\"t\":1,\"key\":\"w\"}") == "in.jsonl:1:8: error: expected \"down\": true or false");
  CHECK(complaint("{\"t\":1,\"key\":7}") == "in.jsonl:1:8: error: expected \"key\": the name of a key");
  CHECK(complaint("{\"t\":1,\"set\":\"nothing\",\"value\":\"1\"}").find("in.jsonl:1:8: error: ") == 0);
  CHECK(complaint("{\"t\":1,\"set\":\"A.b\"}").find("expected \"value\"") != std::string::npos);
}

TEST_CASE("trace prints each event with its timestamp, equally each time") {
  const ScratchFolder folder;
  const std::string world = folder.write("world.wrl", kWorld);
  const Run first = run("trace " + quoted(world) + " --until 0.2");
  CHECK(first.status == kDone);
  CHECK(first.output.starts_with("946684800 V1.isBound TRUE\n946684800 V1.bindTime 946684800\n"));
  CHECK(first.output.find("946684800.05 Clock.isActive TRUE\n") != std::string::npos);
  CHECK(first.output.find(" Path.value_changed 2 0 0\n") != std::string::npos);
  CHECK(first.output.find(" Place.translation_changed 2 0 0\n") != std::string::npos);
  CHECK(first.output.find(" Clock.isActive FALSE\n") != std::string::npos);
  CHECK(run("trace " + quoted(world) + " --until 0.2").output == first.output);
  CHECK(run("trace " + quoted(world)).status == kUsage);
  CHECK(run("trace --until 1 nowhere.wrl").status == kFailed);
}

TEST_CASE("trace performs the input of --input") {
  const ScratchFolder folder;
  const std::string world = folder.write("world.wrl", kWorld);
  const std::string input = folder.write("in.jsonl",
                                         "{\"t\":0.01,\"viewpoint\":\"Back\"}\n"
                                         "{\"t\":0.02,\"set\":\"Transform#2.set_scale\",\"value\":\"1 2 3\"}\n"
                                         "{\"t\":0.02,\"set\":\"Place.removeChildren\",\"value\":\"[Shape#1]\"}\n");
  const Run result = run("trace " + quoted(world) + " --until 0.03 --input " + quoted(input));
  CHECK(result.status == kDone);
  CHECK(result.output.find("946684800.01 V1.isBound FALSE\n") != std::string::npos);
  CHECK(result.output.find("946684800.01 V2.isBound TRUE\n") != std::string::npos);
  CHECK(result.output.find("946684800.02 Transform#2.scale_changed 1 2 3\n") != std::string::npos);
  CHECK(result.output.find("946684800.02 Place.children_changed [ ]\n") != std::string::npos);

  const std::string bad =
      folder.write("bad.jsonl",
                   "{\"t\":0,\"set\":\"Nobody.set_scale\",\"value\":\"1 2 3\"}\n"
                   "{\"t\":0,\"set\":\"Place.set_nothing\",\"value\":\"1 2 3\"}\n"
                   "{\"t\":0,\"set\":\"Place.set_scale\",\"value\":\"1 2\"}\n"
                   "{\"t\":0,\"set\":\"Place.set_scale\",\"value\":\"1 2 3 ] field SFBool b TRUE\"}\n"
                   "{\"t\":0,\"viewpoint\":\"Nowhere\"}\n");
  const Run wrong = run("trace " + quoted(world) + " --until 1 --input " + quoted(bad));
  CHECK(wrong.status == kFailed);
  CHECK(wrong.output.find("bad.jsonl:1:8: error: no node 'Nobody'") != std::string::npos);
  CHECK(wrong.output.find("bad.jsonl:2:8: error: Transform has no eventIn 'set_nothing'") != std::string::npos);
  CHECK(wrong.output.find("bad.jsonl:3:32: error: expected a value of type SFVec3f") != std::string::npos);
  CHECK(wrong.output.find("bad.jsonl:4:32: error: expected a value of type SFVec3f") != std::string::npos);
  CHECK(wrong.output.find("bad.jsonl:5:8: error: no Viewpoint 'Nowhere'") != std::string::npos);
  CHECK(wrong.output.find("isBound") == std::string::npos);
}

TEST_CASE("trace clicks on a TouchSensor by pixels (6.51)") {
  const std::string rows =
      "{\"t\":0.1,\"move\":[50,50]}\n{\"t\":0.2,\"press\":[50,50]}\n{\"t\":0.3,\"release\":[50,50]}\n"
      "{\"t\":0.4,\"move\":[99,99]}\n";
  const std::string lines =
      "946684800.1 T.isOver TRUE\n946684800.1 T.hitPoint_changed 0 0 0\n946684800.1 T.hitNormal_changed 0 0 1\n"
      "946684800.1 T.hitTexCoord_changed 0.5 0.5\n946684800.2 T.isActive TRUE\n946684800.3 T.isActive FALSE\n"
      "946684800.3 T.touchTime 946684800.3\n946684800.4 T.isOver FALSE\n";
  CHECK(pointed(kSensors, "--size 100x100", rows) == lines);
  CHECK(pointed(kSensors, "--size 100x100", rows) == lines);
  // The same pixels in a wider picture. The wider picture shows more at the sides, so these pixels miss the Anchor's
  // box.
  CHECK(pointed(kSensors, "--size 300x100", "{\"t\":0,\"move\":[150,50]}\n{\"t\":1,\"move\":[50,50]}") ==
        "946684800 T.isOver TRUE\n946684800 T.hitPoint_changed 0 0 0\n946684800 T.hitNormal_changed 0 0 1\n"
        "946684800 T.hitTexCoord_changed 0.5 0.5\n946684801 T.isOver FALSE\n");
  // A press and release at once take two timestamps.
  CHECK(pointed(kSensors, "--size 100x100", "{\"t\":0.5,\"press\":[50,50]}\n{\"t\":0.5,\"release\":[50,50]}")
            .find("946684800.5 T.isActive TRUE\n946684800.5166667 T.isActive FALSE\n946684800.5166667 T.touchTime") !=
        std::string::npos);
}

TEST_CASE("gives the pointer only to the geometry nearest to the viewer (4.6.7.3)") {
  // The sensor's box is partly behind another box; its right part is visible.
  const std::string world = R"(#VRML V2.0 utf8
Viewpoint { }
Group { children [ Transform { translation 2 0 -2 children Shape { geometry Box { size 6 2 2 } } } DEF T TouchSensor { } ] }
Shape { geometry Box { } })";
  CHECK(pointed(world, "--size 100x100",
                "{\"t\":0.1,\"press\":[50,50]}\n{\"t\":0.2,\"release\":[50,50]}\n{\"t\":0.3,\"move\":[70,50]}")
            .starts_with("946684800.3 T.isOver TRUE\n"));
}

TEST_CASE("trace drags sensors by pixels, and prints no events of an Anchor (4.6.7.4, 6.2)") {
  CHECK(pointed(kSensors, "--size 100x100",
                "{\"t\":0.1,\"press\":[30,50]}\n{\"t\":0.2,\"move\":[70,20]}\n{\"t\":0.3,\"release\":[70,20]}") ==
        "946684800.1 P.isActive TRUE\n946684800.2 P.trackPoint_changed 7.6 5.3999996 1\n946684800.2 "
        "P.translation_changed 1 1 0\n"
        "946684800.3 P.isActive FALSE\n946684800.3 P.offset_changed 1 1 0\n");
  CHECK(pointed(kSensors, "--size 100x100",
                "{\"t\":0.1,\"press\":[70,50]}\n{\"t\":0.2,\"move\":[75,50]}\n{\"t\":0.3,\"release\":[99,50]}") ==
        "946684800.1 S.isActive TRUE\n946684800.2 S.trackPoint_changed 0.53682727 0 1.9263449\n"
        "946684800.2 S.rotation_changed 0 1 0 0.46548423\n946684800.3 S.isActive FALSE\n"
        "946684800.3 S.offset_changed 0 1 0 0.46548423\n");
  CHECK(pointed(kSensors, "--size 100x100",
                "{\"t\":0.1,\"press\":[50,28]}\n{\"t\":0.2,\"move\":[55,28]}\n{\"t\":0.3,\"release\":[50,28]}") ==
        "946684800.1 C.isActive TRUE\n946684800.2 C.trackPoint_changed 0.9334688 -0.89273727 1.6653112\n"
        "946684800.2 C.rotation_changed 0 1 0 0.51089716\n946684800.3 C.trackPoint_changed 0 -1 1.9090903\n"
        "946684800.3 C.rotation_changed 0 1 0 0\n946684800.3 C.isActive FALSE\n946684800.3 C.offset_changed 0\n");
  CHECK(pointed(kSensors, "--size 100x100", "{\"t\":0.1,\"press\":[50,75]}\n{\"t\":0.2,\"release\":[50,75]}").empty());
}

TEST_CASE("presses a sensor by its name, whatever hides it (4.6.7.3)") {
  const std::string world = R"(#VRML V2.0 utf8
Viewpoint { }
Shape { geometry Box { size 9 9 1 } }
Transform { translation 0 0 -3 children [ Shape { geometry Box { } } DEF T TouchSensor { } ] }
Transform { translation 0 0 30 children [ Shape { geometry Box { } } PlaneSensor { maxPosition 1 1 } ] }
Group { children [ Shape { geometry IndexedLineSet { coord Coordinate { point [ 0 0 0, 1 1 0 ] } coordIndex [ 0 1 ] } }
  DEF L TouchSensor { } ] }
DEF G Group { })";
  // No pixel shows the sensor's box, because another box hides it.
  CHECK(pointed(world, "", "{\"t\":0.1,\"press\":[512,384]}\n{\"t\":0.2,\"release\":[512,384]}\n").empty());
  CHECK(pointed(world, "", "{\"t\":0.1,\"press\":\"T\"}\n{\"t\":0.2,\"release\":true}\n") ==
        "946684800.1 T.isOver TRUE\n946684800.1 T.hitPoint_changed 0 0 1\n946684800.1 T.hitNormal_changed 0 0 1\n"
        "946684800.1 T.hitTexCoord_changed 0.5 0.5\n946684800.1 T.isActive TRUE\n946684800.2 T.isActive FALSE\n"
        "946684800.2 T.touchTime 946684800.2\n");
  // A drag that ends outside of the sensor sends no touchTime.
  const std::string left =
      pointed(world, "", "{\"t\":0.1,\"press\":\"T\"}\n{\"t\":0.2,\"drag\":[300,0]}\n{\"t\":0.3,\"release\":true}\n");
  CHECK(left.find("946684800.2 T.isOver FALSE\n946684800.3 T.isActive FALSE\n") != std::string::npos);
  CHECK(left.find("touchTime") == std::string::npos);
  // The sensor is behind the viewer, and the pointer's line leads backwards. So a drag to the left moves to the right
  // of the world.
  const std::string dragged = pointed(world, "",
                                      "{\"t\":0.1,\"press\":\"PlaneSensor#1\"}\n{\"t\":0.2,\"drag\":[-9,-9]}\n"
                                      "{\"t\":0.3,\"release\":true}\n");
  INFO(dragged);
  const std::size_t moved = dragged.find("946684800.2 PlaneSensor#1.translation_changed 0.");
  REQUIRE(moved != std::string::npos);
  CHECK(dragged.find(" 0.", moved + 52) < dragged.find('\n', moved));
  CHECK(dragged.find("PlaneSensor#1.offset_changed 0.") != std::string::npos);
  // Lines are not picked.
  CHECK(pointed(world, "", "{\"t\":0.1,\"press\":\"L\"}\n")
            .find("in.jsonl:1:10: warning: no visible object is sensed by 'L', or it is disabled; not pressed\n") !=
        std::string::npos);
  const ScratchFolder folder;
  const std::string file = folder.write("world.wrl", world);
  const auto wrong = [&](const std::string& row) {
    const Run result = run("trace " + quoted(file) + " --until 1 --input " + quoted(folder.write("in.jsonl", row)));
    CHECK(result.status == kFailed);
    return result.output;
  };
  CHECK(wrong("{\"t\":0.1,\"press\":\"G\"}\n").find("Group is not a pointing-device sensor") != std::string::npos);
  CHECK(wrong("{\"t\":0.1,\"press\":\"N\"}\n").find("no node 'N'") != std::string::npos);
}

TEST_CASE("--press-sensors presses each sensor, visits each proximity box, and counts them (4.6.7)") {
  const ScratchFolder folder;
  const std::string world = folder.write("world.wrl", kSensors + R"(
Transform { translation 100 0 0 children DEF Near ProximitySensor { center 0 5 0 size 1 1 1 } }
Switch { whichChoice -1 choice Group { children [ Shape { geometry Box { } } DEF Hidden TouchSensor { } ] } }
Inline { url "part.wrl" }
DEF Open Script { directOutput TRUE eventIn SFTime go url "javascript: function go() { print('pressed'); }" }
ROUTE T.touchTime TO Open.go)");
  (void)folder.write("part.wrl",
                     "#VRML V2.0 utf8\nGroup { children [ Shape { geometry Cone { } } DEF Part TouchSensor { } ] }");
  const Run first = run("trace " + quoted(world) + " --until 3 --press-sensors");
  CHECK(first.status == kDone);
  for (const char* line : {" T.touchTime ", " P.translation_changed ", " S.rotation_changed ", " C.rotation_changed ",
                           " Part.touchTime ", " Near.isActive TRUE\n", " Near.isActive FALSE\n", " print pressed\n"}) {
    INFO(line);
    CHECK(first.output.find(line) != std::string::npos);
  }
  CHECK(first.output.find("note: 6 of 7 sensors and Anchors pressed, 1 of 1 ProximitySensors visited") !=
        std::string::npos);
  CHECK(run("trace " + quoted(world) + " --until 3 --press-sensors").output == first.output);
  CHECK(run("--press-sensors " + quoted(world)).status == kUsage);
}

TEST_CASE("moves the viewer to the position in a row of --input (6.38)") {
  const std::string world = "#VRML V2.0 utf8\nViewpoint { }\nDEF P ProximitySensor { center 50 0 0 size 2 2 2 }";
  const std::string lines = pointed(world, "", "{\"t\":0.5,\"viewer\":[50,0.5,0]}");
  CHECK(lines.find(" P.isActive TRUE\n") != std::string::npos);
  CHECK(lines.find(" P.position_changed 50 0.5 0\n") != std::string::npos);
}

TEST_CASE("frames the whole world for the pointer like --snapshot if there is no Viewpoint") {
  const std::string world =
      "#VRML V2.0 utf8\nDEF M Transform { translation 700 0 0 children [ Shape { geometry Sphere { radius 30 } } "
      "DEF T PlaneSensor { } ] } ROUTE T.translation_changed TO M.translation";
  const std::string lines = pointed(world, "--size 64x64",
                                    "{\"t\":0.1,\"press\":[32,32]}\n{\"t\":0.2,\"move\":[48,32]}\n"
                                    "{\"t\":0.3,\"move\":[32,32]}\n{\"t\":0.4,\"release\":[32,32]}");
  CHECK(lines.starts_with("946684800.1 T.isActive TRUE\n946684800.2 T.trackPoint_changed "));
  // The Background stays while the sphere moves.
  CHECK(lines.find("946684800.3 T.translation_changed 0 0 0\n") != std::string::npos);
}

TEST_CASE("shows the result of clicks in a snapshot") {
  const ScratchFolder folder;
  const std::string world = folder.write("world.wrl", R"(#VRML V2.0 utf8
Viewpoint { } DEF M Transform { children [ Shape { geometry Box { } } DEF T PlaneSensor { maxPosition 2 0 } ] }
ROUTE T.translation_changed TO M.translation)");
  const std::string moved = folder.write("moved.wrl", R"(#VRML V2.0 utf8
Viewpoint { } Transform { translation 2 0 0 children [ Shape { geometry Box { } } ] })");
  const std::string input = folder.write("in.jsonl", "{\"t\":0.1,\"press\":[32,32]}\n{\"t\":0.2,\"move\":[63,32]}\n");
  const auto picture = [&](const std::string& name, const std::string& arguments) {
    const Run drawn = run(arguments + " --size 64x64 --snapshot " + quoted(folder.path(name)));
    INFO(drawn.output);
    CHECK(drawn.status == kDone);
    return run_shell("cksum < " + quoted(folder.path(name))).output;
  };
  const std::string dragged = picture("1.png", "--time 0.3 --input " + quoted(input) + " " + quoted(world));
  CHECK(dragged == picture("2.png", quoted(moved)));
  CHECK(dragged != picture("3.png", quoted(world)));
}

TEST_CASE("draws pictures before the background of the window: a gradient, except for worlds") {
  const ScratchFolder folder;
  const std::string world = folder.write("a.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }"),
                    mesh = folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto picture = [&](const std::string& name, const std::string& arguments) {
    const Run drawn = run(arguments + " --size 64x64 --snapshot " + quoted(folder.path(name)));
    INFO(drawn.output);
    CHECK(drawn.status == kDone);
    return run_shell("cksum < " + quoted(folder.path(name))).output;
  };
  CHECK(picture("1.png", quoted(mesh)) == picture("2.png", "--background gradient " + quoted(mesh)));
  CHECK(picture("1.png", quoted(mesh)) != picture("3.png", "--background world " + quoted(mesh)));
  CHECK(picture("3.png", "--background world " + quoted(mesh)) == picture("4.png", "--background 0,0,0 " + quoted(mesh)));
  CHECK(picture("5.png", quoted(world)) == picture("6.png", "--background world " + quoted(world)));
  CHECK(picture("5.png", quoted(world)) != picture("7.png", "--background gradient " + quoted(world)));
}

TEST_CASE("draws the picture at the simulated time of --time") {
  const ScratchFolder folder;
  const std::string world = folder.write("world.wrl", kWorld), still = folder.write("still.wrl", R"(#VRML V2.0 utf8
Viewpoint { } Transform { translation 2 0 0 children
  Shape { geometry Box { } appearance Appearance { material Material { } } } })");
  const std::string size = " --size 64x64 --snapshot ";
  const auto picture = [&](const std::string& name, const std::string& arguments) {
    const Run drawn = run(arguments + size + quoted(folder.path(name)));
    INFO(drawn.output);
    CHECK(drawn.status == kDone);
    return run_shell("cksum < " + quoted(folder.path(name))).output;
  };
  const std::string begin = picture("0.png", quoted(world)), end = picture("1.png", "--time 1 " + quoted(world));
  CHECK(begin != end);
  CHECK(picture("2.png", "--time 1 " + quoted(world)) == end);
  CHECK(picture("3.png", quoted(still)) == end);
  const std::string input = folder.write("in.jsonl", "{\"t\":0.01,\"viewpoint\":2}\n");
  CHECK(picture("4.png", "--time 1 --input " + quoted(input) + " " + quoted(world)) ==
        picture("5.png", "--time 1 --viewpoint Back " + quoted(world)));
  CHECK(run("--time 1 " + quoted(world)).status == kUsage);
  CHECK(run("--time soon" + size + "a.png " + quoted(world)).status == kUsage);
}

TEST_CASE("animates the demo world, with its gate and lantern after a click") {
  const ScratchFolder folder;
  const std::string world = quoted(GHOSTSPACE_TESTS "/../assets/worlds/demo.wrl");
  const Run checked = run("check " + world);
  CHECK(checked.status == kDone);
  CHECK(checked.output.find("warning") == std::string::npos);

  const Run still = run("trace " + world + " --until 1");
  CHECK(still.status == kDone);
  // The demo world moves its lighthouse, the boat, the pennant in another file and the gulls in PROTO instances, for
  // example.
  for (const char* moved : {" Rays.rotation_changed ", " Boat.translation_changed ", " Boat.rotation_changed ",
                            " Pennant.point_changed ", " Circle.rotation_changed ", " Wing.rotation_changed "}) {
    INFO(moved);
    CHECK(still.output.find(moved) != std::string::npos);
  }
  CHECK(still.output.find(" GateLeaf.") == std::string::npos);
  CHECK(still.output.find(" Flame.") == std::string::npos);

  const std::string input = folder.write("in.jsonl",
                                         "{\"t\":1,\"set\":\"GateClock.set_startTime\",\"value\":946684801}\n"
                                         "{\"t\":1,\"set\":\"LampClock.set_startTime\",\"value\":946684801}\n");
  const std::string clicked = run("trace " + world + " --until 17 --input " + quoted(input)).output;
  const auto ends = [&](const std::string& event, const std::string& value) {
    INFO(event);
    const std::size_t last = clicked.rfind(event);
    REQUIRE(last != std::string::npos);
    CHECK(clicked.substr(last, clicked.find('\n', last) - last) == event + value);
  };
  CHECK(clicked.find("946684804 GateLeaf.rotation_changed 0 -1 0 1.5\n") != std::string::npos);
  ends("GateLeaf.rotation_changed ", "0 1 0 0");
  CHECK(clicked.find("946684804 Flame.emissiveColor_changed 1 0.88 0.56\n") != std::string::npos);
  ends("Flame.emissiveColor_changed ", "0.62 0.4 0.16");
  ends("PierLight.intensity_changed ", "0.8");
}

TEST_CASE("reports the received part of a QNV node's stream, and its completion") {
  const ScratchFolder folder;
  const std::string box = folder.write("box.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\n");
  REQUIRE(run("encode " + quoted(box) + " " + quoted(folder.path("box.qnv")) + " --vectors 500").status == kDone);
  const std::string world =
      folder.write("world.wrl",
                   "#VRML V2.0 utf8\nShape { geometry DEF Q QNV { url \"box.qnv\" } }\nDEF T Transform { }\n"
                   "DEF I PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 5 0 0 ] }\n"
                   "ROUTE Q.progress_changed TO I.set_fraction ROUTE I.value_changed TO T.translation\n");
  const auto traced = run("trace " + quoted(world) + " --until 0.1");
  CHECK(traced.status == kDone);
  CHECK(traced.output ==
        "946684800 Q.progress_changed 1\n946684800 Q.loadTime 946684800\n946684800 I.value_changed 5 0 0\n"
        "946684800 T.translation_changed 5 0 0\n");
}

TEST_CASE("starts a trace at the Viewpoint that the fragment of the world's URL names (VRML97 4.5.2)") {
  const ScratchFolder folder;
  const std::string file = folder.write("world.wrl", kWorld);
  const auto bound = [&](const std::string& name) {
    const Run result = run("trace " + quoted(name) + " --until 0");
    CHECK(result.status == kDone);
    return result.output.find("946684800 V2.isBound TRUE\n") != std::string::npos;
  };
  CHECK_FALSE(bound(file));
  CHECK(bound(file + "#V2"));
  CHECK_FALSE(bound(file + "#V3"));  // reported, but not fatal
}

}  // namespace gs::app::trace_test
