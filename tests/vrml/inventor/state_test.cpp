#include "tests/vrml/inventor/converted.h"
#include "vrml/scene/values/transformation.h"

#include <sstream>

using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

const std::string kGrey = "appearance Appearance { material Material { ambientIntensity 0.25 } } ";

std::string shape(const std::string& geometry) { return "Shape { " + kGrey + "geometry " + geometry + " } "; }

}  // namespace

TEST_CASE("converts the transforms of a Separator to Transforms around its shapes") {
  check_converts(kVrml1 + "Separator { Translation { translation 1 2 3 } Sphere { } }",
                 "Transform { translation 1 2 3 children " + shape("Sphere { }") + "}");
  check_converts(kVrml1 +
                     "Separator { Transform { translation 1 0 0 rotation 0 1 0 1 scaleFactor 2 3 4 "
                     "scaleOrientation 1 0 0 1 center 5 6 7 } Sphere { } }",
                 "Transform { translation 1 0 0 rotation 0 1 0 1 scale 2 3 4 scaleOrientation 1 0 0 1 center 5 6 7 "
                 "children " +
                     shape("Sphere { }") + "}");
  // Transforms accumulate, and end with the Separator.
  check_converts(
      kVrml1 +
          "Separator { Sphere { } Separator { Translation { translation 1 0 0 } Sphere { radius 2 } "
          "Rotation { rotation 0 0 1 1 } Scale { scaleFactor 2 1 1 } Sphere { radius 3 } } Sphere { } }",
      "Group { children [ Shape { appearance DEF A Appearance { material Material { ambientIntensity 0.25 } } "
      "geometry Sphere { } } Transform { translation 1 0 0 children [ Shape { appearance USE A geometry "
      "Sphere { radius 2 } } Transform { rotation 0 0 1 1 scale 2 1 1 children Shape { appearance USE A "
      "geometry Sphere { radius 3 } } } ] } Shape { appearance USE A geometry Sphere { } } ] }");
  check_converts(kVrml1 + "Separator { TransformSeparator { Translation { translation 1 0 0 } Sphere { } } Cube { } }",
                 "Group { children [ Transform { translation 1 0 0 children Shape { appearance DEF A Appearance { "
                 "material Material { ambientIntensity 0.25 } } geometry Sphere { } } } Shape { appearance USE A "
                 "geometry Box { } } ] }");
}

TEST_CASE("decomposes matrices, with shear and mirrors") {
  for (const char* matrix : {"1 0 0 0 0 1 0 0 0 0 1 0 4 5 6 1", "1 0 0 0 0.5 1 0 0 0 0.25 1 0 0 0 0 1",
                             "-1 0 0 0 0 2 0 0 0 0 1 0 1 2 3 1", "0 2 0 0 -3 0 0 0 0 0 1 0 0 0 0 1"}) {
    const Converted world(kInventor + "Separator { MatrixTransform { matrix " + matrix + " } Sphere { } }");
    INFO(matrix << world.messages());
    REQUIRE(world.scene.roots().size() == 1);
    const NodeId transform = world.scene.roots()[0];
    const auto get = [&](const char* field) { return world.scene.get<SFVec3f>(transform, field); };
    const auto turn = [&](const char* field) { return world.scene.get<SFRotation>(transform, field); };
    const glm::dmat4 found =
        transform_matrix(get("translation"), get("center"), turn("rotation"), get("scale"), turn("scaleOrientation"));
    std::istringstream numbers{std::string(matrix)};
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 4; ++row) {
        double number = 0;
        numbers >> number;
        CHECK(found[column][row] == Approx(number).margin(1e-5));
      }
  }
}

TEST_CASE("reports a matrix that no Transform can express") {
  CHECK(Converted(kInventor + "Separator { MatrixTransform { matrix 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1 } Cube { } }")
            .says("matrix has no exact Transform"));
}

TEST_CASE("shares equal materials, coordinates and appearances") {
  const Converted world(kVrml1 +
                        "Separator { Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] } Material { diffuseColor 1 0 0 } "
                        "IndexedFaceSet { coordIndex [ 0, 1, 2 ] } Material { diffuseColor 1 0 0 } "
                        "IndexedLineSet { coordIndex [ 0, 1, 2 ] } IndexedFaceSet { coordIndex [ 2, 1, 0 ] } }");
  const std::string text = print(world.scene);
  const auto count = [&](std::string_view word) {
    std::size_t found = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
    return found;
  };
  CHECK(count("Coordinate {") == 1);
  CHECK(count("Appearance {") == 2);  // lines are not lit
}

TEST_CASE("uses a Separator again if the state that it reads is equal") {
  const std::string part = "DEF S Separator { Material { } Cube { } } Material { diffuseColor 1 0 0 } USE S";
  CHECK(print(Converted(kVrml1 + "Separator { " + part + " }").scene).find("USE S") != std::string::npos);
  const std::string bare = "DEF S Separator { Cube { } } Material { diffuseColor 1 0 0 } USE S USE S";
  const Converted world(kVrml1 + "Separator { " + bare + " }");
  const std::string text = print(world.scene);
  CHECK(text.find("diffuseColor 1 0 0") != std::string::npos);
  CHECK(text.find("USE S") != std::string::npos);  // the second red one
}

TEST_CASE("limits the work of nested uses") {
  std::string groups = kInventor + "DEF G0 Group { Translation { } }\n",
              separators = kInventor + "DEF G0 Separator { Cube { } }\n";
  for (int i = 1; i <= 40; ++i) {
    const std::string name = "G" + std::to_string(i), before = "USE G" + std::to_string(i - 1);
    groups += "DEF " + name + " Group { " + before + " " + before + " }\n";
    separators += "DEF " + name + " Separator { " + before + " " + before + " }\n";
  }
  const Converted many(groups + "Cube { }");
  CHECK(many.says("skipped the remaining nodes"));
  const Converted shared(separators);
  CHECK(shared.messages().empty());
  CHECK(shared.scene.nodes().count() < 300);
}

TEST_CASE("converts lights, which light the later nodes of their Separator") {
  const Converted world(kVrml1 + "Separator { Sphere { } DirectionalLight { direction 1 0 0 } Cube { } }");
  const std::string text = print(world.scene);
  CHECK(text.find("Sphere") < text.find("Group", text.find("Sphere")));
  CHECK(text.find("Group", text.find("Sphere")) < text.find("DirectionalLight"));
}

TEST_CASE("converts cameras to Viewpoints, also the cameras that a Switch does not choose") {
  check_converts(kVrml1 +
                     "DEF Cameras Switch { whichChild 0 DEF Front PerspectiveCamera { position 0 0 9 heightAngle 1 } "
                     "DEF Side PerspectiveCamera { position 9 0 0 orientation 0 1 0 1 } }",
                 "DEF Front Viewpoint { position 0 0 9 fieldOfView 1 description \"Front\" } "
                 "DEF Side Viewpoint { position 9 0 0 orientation 0 1 0 1 description \"Side\" }");
}

TEST_CASE("converts LOD, Switch, anchors, Inlines and texts") {
  check_converts(kVrml1 + "LOD { range [ 10 ] center 1 0 0 Separator { Sphere { } } Separator { } }",
                 "LOD { range 10 center 1 0 0 level [ Group { children " + shape("Sphere { }") + "} Group { } ] }");
  check_converts(kVrml1 + "Switch { whichChild 1 Separator { } Separator { Sphere { } } }",
                 "Switch { whichChoice 1 choice [ Group { } Group { children " + shape("Sphere { }") + "} ] }");
  check_converts(kVrml1 + "Switch { Cube { } } Switch { whichChild -3 Sphere { } }", shape("Sphere { }"));
  check_converts(kVrml1 + "WWWAnchor { name \"a.wrl\" description \"go\" Sphere { } }",
                 "Anchor { url \"a.wrl\" description \"go\" children " + shape("Sphere { }") + "}");
  check_converts(kVrml1 + "WWWInline { name \"a.wrl\" bboxSize 1 2 3 }", "Inline { url \"a.wrl\" bboxSize 1 2 3 }");
  check_converts(kInventor + "File { name \"a.iv\" }", "Inline { url \"a.iv\" }");
  check_converts(kVrml1 +
                     "FontStyle { size 2 family SANS style (BOLD|ITALIC) } AsciiText { string [ \"a\", \"b\" ] "
                     "justification CENTER spacing 2 width [ 0, 5 ] }",
                 "Shape { " + kGrey +
                     "geometry Text { string [ \"a\" \"b\" ] length [ 0 5 ] fontStyle FontStyle { size 2 "
                     "family \"SANS\" style \"BOLDITALIC\" justify \"MIDDLE\" spacing 2 } } }");
}

TEST_CASE("converts Info nodes with hints for the viewer") {
  check_converts(kVrml1 +
                     "DEF BackgroundColor Info { string \"0 0.5 1\" } DEF Viewer Info { string \"walk\" } "
                     "DEF Title Info { string \"Shore\" } Info { string \"by hand\" }",
                 "Background { skyColor 0 0.5 1 } NavigationInfo { type [ \"WALK\" \"ANY\" ] } "
                 "WorldInfo { title \"Shore\" } WorldInfo { info \"by hand\" }");
}

TEST_CASE("animates Rotor, Pendulum, Shuttle and Blinker") {
  const Converted world(
      kInventor +
      "Separator { Rotor { rotation 0 1 0 0 speed 0.5 } Cube { } Separator { Shuttle { translation1 0 2 0 "
      "} Sphere { } } Separator { Pendulum { rotation1 0 0 1 1 } Cone { } } Blinker { Cube { } Sphere { } "
      "} Rotor { on FALSE } Cube { } }");
  CHECK(world.messages().empty());
  CHECK(world.scene.routes().size() == 8);
  const std::string text = print(world.scene);
  CHECK(text.find("cycleInterval 2") != std::string::npos);
  for (const char* words : {".value_changed TO _Rotor", ".value_changed TO _Shuttle", ".value_changed TO _Pendulum",
                            ".choice TO _Blinker"}) {
    INFO(words);
    CHECK(text.find(words) != std::string::npos);
  }
}

TEST_CASE("passes the point of a click to the url of a WWWAnchor with map POINT") {
  const Converted world(kVrml1 + "WWWAnchor { name \"it's.cgi\" map POINT Cube { } }");
  CHECK(world.messages().empty());
  CHECK(world.scene.routes().size() == 2);
  CHECK(print(world.scene).find("Browser.loadURL(new MFString('it\\\\'s.cgi?' + at[0]") != std::string::npos);
}

TEST_CASE("converts orthographic cameras, clip planes and environment maps to nodes of X3D") {
  const Converted world(
      kInventor +
      "Separator { OrthographicCamera { position 1 2 3 height 4 } Sphere { } Translation { translation 2 0 0 "
      "} ClipPlane { plane 1 0 0 1 } Texture2 { image 1 1 1 0xff } TextureCoordinateEnvironment { } "
      "Coordinate3 { point [ 0 0 0, 1 0 0, 0 1 0 ] } FaceSet { numVertices 3 } }");
  CHECK(world.messages().empty());
  const SceneGraph& scene = world.scene;
  int found = 0;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const NodeId id = scene.nodes().id_at(i);
    if (const auto* declaration = scene.node(id).type->find_field("plane")) {
      CHECK(std::get<SFVec4f>(scene.node(id).values[declaration->slot]) == glm::vec4(1, 0, 0, -3));
      ++found;
    }
    if (scene.node(id).type->kind == NodeType::Kind::built_in && scene.node(id).type->find_field("mapping")) ++found;
    const auto* view = scene.node(id).type->find_field("fieldOfView");
    if (view && view->type == FieldType::MFFloat) {
      CHECK(scene.get<MFFloat>(id, "fieldOfView") == MFFloat{-2, -2, 2, 2});
      ++found;
    }
  }
  CHECK(found == 3);
  CHECK(print(scene).find("Viewpoint {") != std::string::npos);  // VRML97 has no OrthoViewpoint
}
