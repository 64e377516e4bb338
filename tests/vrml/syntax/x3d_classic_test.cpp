#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace gs;
using namespace gs::vrml;

namespace {

struct ReadX3d {
  SceneGraph scene{"text.x3dv"};
  Diagnostics diagnostics;
  ParseOutcome outcome;

  explicit ReadX3d(const std::string& body, const std::string& header = "#X3D V3.3 utf8\n") {
    outcome = parse(header + body, scene, diagnostics);
  }
  [[nodiscard]] NodeId root(std::size_t i = 0) const { return scene.roots()[i]; }
  [[nodiscard]] std::string said() const {
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics.entries()) text += diagnostic.text() + "\n";
    return text;
  }
};

}  // namespace

TEST_CASE("reads language and version from the header of a classic X3D file") {
  for (const auto& [header, version] : std::vector<std::pair<std::string, int>>{
           {"#X3D V3.0 utf8\n", 30}, {"#X3D V3.3 utf8 Titania V4.0\r\n", 33}, {"#X3D V4.0 utf8\r", 40}}) {
    const ReadX3d read("Group { }", header);
    CHECK(read.outcome == ParseOutcome::complete);
    CHECK(read.said().empty());
    CHECK(read.scene.language() == Language::x3d);
    CHECK(read.scene.version() == version);
    CHECK(read.scene.roots().size() == 1);
  }
  const ReadX3d vrml("Group { }", "#VRML V2.0 utf8\n");
  CHECK(vrml.scene.language() == Language::vrml97);
  CHECK(vrml.scene.version() == 20);
}

TEST_CASE("keeps the statements of an X3D file with its text") {
  const ReadX3d read(
      "PROFILE Interactive COMPONENT NURBS:2 META \"title\" \"A\" META \"creator\" \"B\" UNIT length inch 0.0254\n"
      "DEF I Inline { } DEF G Group { } IMPORT I.a AS b IMPORT I.c EXPORT G AS g EXPORT b");
  CHECK(read.said().empty());
  const X3DStatements& x3d = read.scene.x3d();
  CHECK(x3d.profile == "Interactive");
  REQUIRE(x3d.components.size() == 1);
  CHECK(x3d.components[0].name == "NURBS");
  CHECK(x3d.components[0].level == 2);
  CHECK(x3d.metas.size() == 2);
  CHECK(x3d.meta("creator") == "B");
  CHECK(x3d.unit("length") == 0.0254);
  CHECK(x3d.unit("angle") == 1);
  REQUIRE(x3d.imports.size() == 2);
  CHECK(x3d.imports[0].inline_node == read.root(0));
  CHECK(x3d.imports[0].exported == "a");
  CHECK(x3d.imports[0].local == "b");
  CHECK(x3d.imports[1].local == "c");
  REQUIRE(x3d.exports.size() == 2);
  CHECK(x3d.exports[0].node == read.root(1));
  CHECK(x3d.exports[0].exported == "g");
  CHECK_FALSE(x3d.exports[1].node);
}

TEST_CASE("declares exposed fields in an X3D Script with the keywords of X3D and VRML97") {
  const ReadX3d read(
      "Script { inputOutput SFFloat x 2 initializeOnly SFBool y TRUE field SFBool z FALSE "
      "inputOnly SFTime t eventOut SFTime u exposedField SFBool v TRUE }");
  CHECK(read.said().empty());
  const NodeType& type = *read.scene.node(read.root()).type;
  REQUIRE(type.find("x"));
  CHECK(type.find("x")->access == AccessType::exposedField);
  CHECK(type.find_event_in("set_x") == type.find("x"));
  CHECK(type.find("y")->access == AccessType::field);
  CHECK(type.find("z")->access == AccessType::field);
  CHECK(type.find("t")->access == AccessType::eventIn);
  CHECK(type.find("u")->access == AccessType::eventOut);
  CHECK(read.scene.get<SFFloat>(read.root(), "x") == 2);
}

TEST_CASE("converts angles of an X3D file with another unit to radians") {
  const std::string degrees = "UNIT angle degree 0.017453292519943295\n";
  constexpr float kQuarter = 1.5707963f;
  const ReadX3d read(degrees +
                     "Transform { rotation 0 1 0 90 }\n"
                     "Viewpoint { fieldOfView 45 }\n"
                     "Viewpoint { }\n"
                     "OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 180 ] }\n"
                     "Background { skyAngle [ 90 ] skyColor [ 1 0 0, 0 1 0 ] }\n"
                     "Script { initializeOnly SFRotation r 1 0 0 90 initializeOnly SFFloat f 90 }");
  CHECK(read.said().empty());
  CHECK(read.scene.get<SFRotation>(read.root(0), "rotation").angle == Approx(kQuarter));
  CHECK(read.scene.get<SFFloat>(read.root(1), "fieldOfView") == Approx(kQuarter / 2));
  CHECK(read.scene.get<SFFloat>(read.root(2), "fieldOfView") == Approx(0.785398));
  CHECK(read.scene.get<MFRotation>(read.root(3), "keyValue")[1].angle == Approx(2 * kQuarter));
  CHECK(read.scene.get<MFFloat>(read.root(4), "skyAngle")[0] == Approx(kQuarter));
  CHECK(read.scene.get<SFRotation>(read.root(5), "r").angle == Approx(kQuarter));
  CHECK(read.scene.get<SFFloat>(read.root(5), "f") == 90);
}

TEST_CASE("converts angles of PROTO fields that IS connects to an angle") {
  const ReadX3d read(
      "UNIT angle degree 0.017453292519943295\n"
      "PROTO P [ initializeOnly SFFloat angle 90 initializeOnly SFFloat size 90 initializeOnly SFRotation r 0 1 0 90 ] "
      "{"
      "  Transform { rotation IS r children [\n"
      "    SpotLight { cutOffAngle IS angle radius IS size } ] } }\n"
      "PROTO Q [ initializeOnly SFFloat outer 60 ] { P { angle IS outer } }\n"
      "P { } P { angle 45 r 0 1 0 180 } Q { }");
  CHECK(read.said().empty());
  const auto light_of = [&](NodeId instance) {
    const NodeId transform = read.scene.resolve(instance);
    return read.scene.resolve(read.scene.get<MFNode>(transform, "children")[0]);
  };
  CHECK(read.scene.get<SFFloat>(light_of(read.root(0)), "cutOffAngle") == Approx(1.5707963));
  CHECK(read.scene.get<SFFloat>(light_of(read.root(0)), "radius") == 90);
  CHECK(read.scene.get<SFRotation>(read.scene.resolve(read.root(0)), "rotation").angle == Approx(1.5707963));
  CHECK(read.scene.get<SFFloat>(light_of(read.root(1)), "cutOffAngle") == Approx(0.78539816));
  CHECK(read.scene.get<SFRotation>(read.scene.resolve(read.root(1)), "rotation").angle == Approx(3.1415927));
  CHECK(read.scene.get<SFFloat>(light_of(read.root(2)), "cutOffAngle") == Approx(1.0471976));
}

TEST_CASE("converts masses and forces of an X3D file with other units to kilograms and newtons") {
  const ReadX3d read(
      "UNIT mass gram 0.001\nUNIT force kilonewton 1000\n"
      "PROTO P [ initializeOnly SFFloat weight 500 ] { PointEmitter { mass IS weight } }\n"
      "ParticleSystem { emitter PointEmitter { mass 250 speed 3 } physics ForcePhysicsModel { force 1 2 3 } }\n"
      "ParticleSystem { emitter P { } }\nRigidBody { mass 4000 forces [ 1 0 0, 0 2 0 ] }");
  CHECK(read.diagnostics.errors() == 0);
  const auto emitter = [&](std::size_t i) {
    return read.scene.resolve(read.scene.get<SFNode>(read.root(i), "emitter"));
  };
  CHECK(read.scene.get<SFFloat>(emitter(0), "mass") == Approx(0.25));
  CHECK(read.scene.get<SFFloat>(emitter(0), "speed") == 3);
  const NodeId model = read.scene.get<MFNode>(read.root(0), "physics")[0];
  CHECK(read.scene.get<SFVec3f>(model, "force") == SFVec3f{1000, 2000, 3000});
  CHECK(read.scene.get<SFFloat>(emitter(1), "mass") == Approx(0.5));
  CHECK(read.scene.get<SFFloat>(read.root(2), "mass") == Approx(4));
  CHECK(read.scene.get<MFVec3f>(read.root(2), "forces")[1] == SFVec3f{0, 2000, 0});
}

TEST_CASE("reads X3D and VRML97 texts of programs in the language of their header") {
  SceneGraph scene("world.wrl");
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nGroup { }", scene, diagnostics);
  const auto language_of = [&](const std::string& text) {
    const RunTimeNodes read = read_into(scene, "text", text, diagnostics);
    REQUIRE(read.roots.size() == 1);
    return scene.node(read.roots[0]).text->language();
  };
  CHECK(language_of("Group { }") == Language::vrml97);
  CHECK(language_of("#X3D V3.0 utf8\nPROFILE Immersive\nGroup { }") == Language::x3d);
  CHECK(language_of("#VRML V2.0 utf8\nGroup { }") == Language::vrml97);
  CHECK(diagnostics.errors() == 0);
  SceneGraph x3d("world.x3dv");
  (void)parse("#X3D V3.0 utf8\nGroup { }", x3d, diagnostics);
  const RunTimeNodes read = read_into(x3d, "text", "Group { /* comment */ }", diagnostics);
  CHECK(x3d.node(read.roots[0]).text->language() == Language::x3d);
  CHECK(diagnostics.errors() == 0);
}

TEST_CASE("limits the number of IMPORT statements") {
  std::string text = "DEF I Inline { }\n";
  for (int i = 0; i < 70000; ++i) text += "IMPORT I.n" + std::to_string(i) + "\n";
  const ReadX3d read(text);
  CHECK(read.diagnostics.errors() == 1);
  CHECK(read.scene.x3d().imports.size() == 65536);
}

TEST_CASE("warns once about a field of other browsers in an X3D file") {
  const ReadX3d read(
      "PROTO P [ inputOutput MFNode list [ ] ] { Shape { appearance Appearance { effects IS list } } }\n"
      "Shape { appearance Appearance { effects [ ] material Material { } } }\n"
      "Shape { appearance Appearance { effects DEF G Group { } } shading \"WIREFRAME\" }\n"
      "DEF V Viewpoint { direction 0 0 1 } DEF T Transform { translation 0 0 1 }\n"
      "ROUTE T.translation TO V.set_direction");
  CHECK(read.diagnostics.errors() == 0);
  CHECK(read.diagnostics.warnings() == 4);
  const ReadX3d unknown("Transform { direction 0 0 1 }");
  CHECK(unknown.diagnostics.errors() == 1);
}

TEST_CASE("reads a text without a header in the language of its reader") {
  for (const Grammar grammar : {Grammar::vrml97, Grammar::x3d_classic}) {
    SceneGraph scene("part.x3dv");
    Diagnostics diagnostics;
    const auto reader = make_reader(grammar, scene, diagnostics);
    reader->push("Script { inputOnly SFTime now url \"\" }");
    CHECK(reader->finish() == ParseOutcome::complete);
    CHECK((diagnostics.errors() == 0) == (grammar == Grammar::x3d_classic));
  }
}
