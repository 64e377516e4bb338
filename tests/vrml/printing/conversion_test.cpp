// X3D scenes as VRML97.
#include "vrml/printing/print_scene.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml::conversion_test {
namespace {

struct Converted {
  std::string text;
  std::vector<std::string> losses;

  [[nodiscard]] bool has_loss(std::string_view part) const {
    return std::any_of(losses.begin(), losses.end(),
                       [&](const std::string& loss) { return loss.find(part) != std::string::npos; });
  }
};

// Converts the nodes of an X3D text to VRML97, and checks that the result has no errors.
Converted converted(const std::string& body) {
  SceneGraph scene("a.x3dv"), again("a.wrl");
  Diagnostics diagnostics, second;
  CHECK(parse("#X3D V3.3 utf8\nPROFILE Full\n" + body, scene, diagnostics) == ParseOutcome::complete);
  CHECK(diagnostics.errors() == 0);
  Converted made;
  made.losses = print_scene(scene, {Grammar::vrml97}, [&](std::string_view piece) {
    made.text += piece;
    return true;
  });
  CHECK(parse(made.text, again, second) == ParseOutcome::complete);
  for (const Diagnostic& diagnostic : second.entries()) UNSCOPED_INFO(diagnostic.text());
  CHECK(second.entries().empty());
  CHECK(printed_scene(again, {Grammar::vrml97}) == made.text);
  made.text.erase(0, std::string_view("#VRML V2.0 utf8\n\n").size());
  return made;
}

}  // namespace

TEST_CASE("converts X3D names to those of VRML97") {
  const Converted made = converted(
      "Switch { children [ Group { } ] whichChoice 0 }\nCollision { enabled FALSE }\n"
      "NavigationInfo { }\nLOD { children Group { } }");
  CHECK(made.text ==
        "Switch {\n  choice Group {}\n  whichChoice 0\n}\n\nCollision { collide FALSE }\n\n"
        "NavigationInfo {\n  type [ \"EXAMINE\", \"ANY\" ]\n}\n\nLOD {\n  level Group {}\n}\n");
  CHECK(made.losses.empty());
}

TEST_CASE("converts sets of triangles and lines to indexed sets with the same Coordinate") {
  const auto geometry = [](const std::string& text) {
    const Converted made = converted("Shape { geometry " + text + " }");
    CHECK(made.losses.empty());
    return made.text;
  };
  const std::string points = "coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0, 0 2 0 ] } ";
  CHECK(geometry("IndexedTriangleSet { " + points + "index [ 0 1 2 0 2 3 ] normalPerVertex FALSE }") == R"(Shape {
  geometry IndexedFaceSet {
    coord Coordinate {
      point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0, 0 2 0 ]
    }
    coordIndex [ 0 1 2 -1 0 2 3 -1 ]
    normalPerVertex FALSE
  }
}
)");
  const auto index = [&](const std::string& text) {
    const std::string made = geometry(text);
    const std::size_t from = made.find("coordIndex [ ") + 13;
    return made.substr(from, made.find(" ]", from) - from);
  };
  CHECK(index("TriangleSet { " + points + "}").starts_with("0 1 2 -1"));
  CHECK(index("TriangleFanSet { " + points + "fanCount 4 }") == "0 1 2 -1 0 2 3 -1");
  CHECK(index("TriangleStripSet { " + points + "stripCount 5 }") == "0 1 2 -1 2 1 3 -1 2 3 4 -1");
  CHECK(index("IndexedTriangleFanSet { " + points + "index [ 0 1 2 3 -1 ] }") == "0 1 2 -1 0 2 3 -1");
  CHECK(index("IndexedTriangleStripSet { " + points + "index [ 0 1 2 3 -1 1 2 3 ] }") == "0 1 2 -1 2 1 3 -1 1 2 3 -1");
  CHECK(index("QuadSet { " + points + "}").starts_with("0 1 2 3 -1"));
  CHECK(index("LineSet { " + points + "vertexCount [ 2 3 ] }") == "0 1 -1 2 3 4");
}

TEST_CASE("converts nodes that have an equivalent, and names the loss") {
  const Converted colors = converted(
      "Shape { geometry PointSet { color ColorRGBA { color [ 1 0 0 0.5 ] } coord CoordinateDouble { point [ 1 2 3 ] } "
      "} }");
  CHECK(colors.text.find("color Color {\n      color [ 1 0 0 ]") != std::string::npos);
  CHECK(colors.text.find("coord Coordinate {\n      point [ 1 2 3 ]") != std::string::npos);
  CHECK(colors.has_loss("ColorRGBA becomes Color"));
  CHECK(converted("StaticGroup { children Shape { } }").text == "Group {\n  children Shape {}\n}\n");
  CHECK(converted("CADFace { shape Shape { } }").text == "Group {\n  children Shape {}\n}\n");
  const Converted disk = converted("Shape { geometry Disk2D { } }");
  CHECK(disk.text.find("geometry IndexedFaceSet") != std::string::npos);
  CHECK(converted("Shape { geometry Circle2D { } }").text.find("geometry IndexedLineSet") != std::string::npos);
}

TEST_CASE("leaves out nodes and fields that VRML97 lacks, and names them") {
  const Converted made = converted(
      "DEF F BooleanFilter { }\nDEF T TouchSensor { description \"door\" }\nDEF L PointLight { }\n"
      "ROUTE T.isActive TO F.set_boolean\nROUTE F.inputTrue TO L.set_on\nROUTE T.isOver TO L.set_on\n"
      "Group { children [ KeySensor { } Shape { } ] }");
  CHECK(made.text ==
        "DEF T TouchSensor {}\n\nDEF L PointLight {}\nROUTE T.isOver TO L.on\n\n"
        "Group {\n  children Shape {}\n}\n");
  CHECK(made.has_loss("BooleanFilter is left out: VRML97 has no such node"));
  CHECK(made.has_loss("KeySensor is left out"));
  CHECK(made.has_loss("the field description of TouchSensor is left out"));
  CHECK(made.has_loss("ROUTEs from or to nodes and events that are left out (2 times)"));
}

TEST_CASE("keeps the statements of X3D in X3D, and names them in VRML97") {
  const std::string text =
      "#X3D V4.0 utf8\n\nPROFILE Immersive\nCOMPONENT Networking:3\nUNIT length inch 0.0254\nMETA \"title\" \"a "
      "\\\"b\\\"\"\n\n"
      "DEF I Inline {\n  url [ \"in.x3d\" ]\n}\n\nDEF G Group {}\n\nIMPORT I.Lamp AS L\nEXPORT G AS Room\n"
      "ROUTE L.on TO G.visible\n";
  SceneGraph scene("a.x3dv");
  Diagnostics diagnostics;
  CHECK(parse(text, scene, diagnostics) == ParseOutcome::complete);
  const std::string classic = printed_scene(scene, {Grammar::x3d_classic});
  CHECK(classic.find(
            "#X3D V4.0 utf8\n\nPROFILE Immersive\nUNIT length inch 0.0254\nMETA \"title\" \"a \\\"b\\\"\"\n") == 0);
  CHECK(classic.find("IMPORT I.Lamp AS L\n") != std::string::npos);
  CHECK(classic.find("EXPORT G AS Room\n") != std::string::npos);
  CHECK(classic.find("ROUTE L.on TO G.visible\n") != std::string::npos);
  for (const Grammar grammar : {Grammar::x3d_xml, Grammar::x3d_json}) {
    SceneGraph again("again");
    Diagnostics second;
    CHECK(parse(printed_scene(scene, {grammar}), again, second) == ParseOutcome::complete);
    CHECK(printed_scene(again, {Grammar::x3d_classic}) == classic);
  }
}

TEST_CASE("keeps the declarations of shaders, and drops EXPORTs of nodes outside of the scene") {
  SceneGraph scene("a.x3dv");
  Diagnostics diagnostics;
  CHECK(parse("#X3D V3.3 utf8\nPROFILE Full\nShape { appearance Appearance { shaders DEF S ComposedShader {\n"
              "inputOutput SFFloat time 1 parts ShaderPart { url \"a.fs\" } } } }\nDEF C TimeSensor { }\n"
              "DEF M NoSuchNode { }\nEXPORT M AS Paint\nEXPORT C\n"
              "ROUTE C.elapsedTime TO S.time\n",
              scene, diagnostics) == ParseOutcome::complete);
  for (const Grammar grammar : {Grammar::x3d_classic, Grammar::x3d_xml, Grammar::x3d_json}) {
    const std::string text = printed_scene(scene, {grammar});
    SceneGraph again("again");
    Diagnostics second;
    CHECK(parse(text, again, second) == ParseOutcome::complete);
    CHECK(second.errors() == 0);
    CHECK(printed_scene(again, {grammar}) == text);
  }
  const std::string classic = printed_scene(scene, {Grammar::x3d_classic});
  CHECK(classic.find("inputOutput SFFloat time 1\n") != std::string::npos);
  CHECK(classic.find("Paint") == std::string::npos);
  CHECK(classic.find("EXPORT C\n") != std::string::npos);
}

TEST_CASE("writes a field that a Script declares and X3D Scripts have") {
  SceneGraph scene("a.wrl");
  Diagnostics diagnostics;
  (void)parse(
      "#VRML V2.0 utf8\nScript { field SFString description \"a\" field SFBool load TRUE eventIn SFTime metadata }",
      scene, diagnostics);
  CHECK(printed_scene(scene, {Grammar::x3d_classic}).find("Script { description \"a\" }\n") != std::string::npos);
}

TEST_CASE("leaves out fields of equivalents with nodes that VRML97 lacks") {
  const Converted made = converted(
      "Shape { geometry TriangleSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } texCoord "
      "TextureCoordinateGenerator { } } }");
  CHECK(made.text.find("texCoord") == std::string::npos);
}

}  // namespace gs::vrml::conversion_test
