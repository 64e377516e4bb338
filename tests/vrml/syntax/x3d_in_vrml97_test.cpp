#include "tests/vrml/events/trace.h"
#include "vrml/printing/print_scene.h"
#include "vrml/syntax/parser.h"

#include <string>

// Fields, events, nodes and statements of X3D in texts with the header of VRML97.
namespace gs::vrml::traces {
namespace {

struct ReadMixed {
  SceneGraph scene{"text.wrl"};
  Diagnostics diagnostics;

  explicit ReadMixed(const std::string& body) { (void)parse("#VRML V2.0 utf8\n" + body, scene, diagnostics); }
  [[nodiscard]] NodeId root(std::size_t i = 0) const { return scene.roots()[i]; }
  [[nodiscard]] const NodeType& type(std::size_t i = 0) const { return *scene.node(root(i)).type; }
  [[nodiscard]] Lines said() const {
    Lines lines;
    for (const Diagnostic& one : diagnostics.entries()) lines.push_back(one.text());
    return lines;
  }
};

}  // namespace

TEST_CASE("reads fields of X3D in nodes of a VRML97 text, with one warning per field") {
  const ReadMixed read(
      "Viewpoint { position 1 2 3 centerOfRotation 4 5 6 description \"a\" }\n"
      "Viewpoint { centerOfRotation 7 8 9 }");
  CHECK(read.said() ==
        Lines{"text.wrl:2:28: warning: 'centerOfRotation' of Viewpoint is of X3D, not of VRML97; read as in X3D"});
  CHECK(read.scene.get<SFVec3f>(read.root(), "position") == SFVec3f{1, 2, 3});
  CHECK(read.scene.get<SFVec3f>(read.root(), "centerOfRotation") == SFVec3f{4, 5, 6});
  CHECK(read.scene.get<SFString>(read.root(), "description") == String("a"));
  CHECK(read.scene.get<SFVec3f>(read.root(1), "centerOfRotation") == SFVec3f{7, 8, 9});
}

TEST_CASE("keeps the default values of VRML97 in nodes with fields of X3D") {
  const ReadMixed read("NavigationInfo { transitionTime 2 }");
  CHECK(read.diagnostics.errors() == 0);
  CHECK(read.scene.get<MFString>(read.root(), "type") == MFString{String("WALK"), String("ANY")});
}

TEST_CASE("keeps correct VRML97 texts apart from X3D") {
  const ReadMixed read(
      "PROTO Rectangle2D [ field SFFloat side 2 ] { Group { } }\n"
      "Rectangle2D { side 3 } Viewpoint { position 1 2 3 } Box { }");
  CHECK(read.diagnostics.errors() == 0);
  CHECK(read.type().kind == NodeType::Kind::prototype);
  CHECK(read.type(1).language == Language::vrml97);
}

TEST_CASE("reports unknown fields of a node that has fields of X3D") {
  const ReadMixed read("Viewpoint { centerOfRotation 4 5 6 bogus 1 }");
  REQUIRE(read.said().size() == 2);
  CHECK(read.said()[1] == "text.wrl:2:36: error: Viewpoint has no field 'bogus'; skipped");
}

TEST_CASE("connects ROUTEs to events of X3D in a VRML97 text") {
  const std::string text = R"(DEF A Viewpoint { } DEF B Viewpoint { }
ROUTE A.position_changed TO B.set_position
ROUTE A.centerOfRotation TO B.set_centerOfRotation
)";
  const ReadMixed read(text);
  CHECK(read.diagnostics.errors() == 0);
  CHECK(read.diagnostics.warnings() == 2);
  CHECK(read.scene.routes().size() == 2);
  World world(text);
  world.start();
  world.send("A.position", SFVec3f{1, 2, 3});
  world.send("A.centerOfRotation", SFVec3f{4, 5, 6});
  CHECK(world.take("B.") == Lines{"0 B.position 1 2 3", "0 B.centerOfRotation 4 5 6"});
}

TEST_CASE("waits with ROUTEs to events of X3D until a node is complete") {
  const ReadMixed read(
      "DEF T Transform { children [ Group { ROUTE T.metadata TO T.set_metadata } Shape { } Group { } ] "
      "scale 2 2 2 }");
  CHECK(read.diagnostics.errors() == 0);
  CHECK(read.scene.get<MFNode>(read.root(), "children").size() == 3);
  CHECK(read.scene.get<SFVec3f>(read.root(), "scale") == SFVec3f{2, 2, 2});
  CHECK(read.type().language == Language::x3d);
  CHECK(read.scene.routes().size() == 1);
}

TEST_CASE("connects interfaces of a PROTO to fields of X3D in a VRML97 text") {
  const ReadMixed read(
      "PROTO P [ exposedField SFVec3f at 1 2 3 exposedField SFVec3f center 4 5 6 ] {\n"
      "  Viewpoint { position IS at centerOfRotation IS center }\n"
      "}\nP { at 7 8 9 }");
  CHECK(read.diagnostics.errors() == 0);
  const NodeId view = read.scene.resolve(read.root());
  CHECK(read.scene.get<SFVec3f>(view, "position") == SFVec3f{7, 8, 9});
  CHECK(read.scene.get<SFVec3f>(view, "centerOfRotation") == SFVec3f{4, 5, 6});
  for (const IsMapping& mapping : read.type().prototype->mappings)
    CHECK(read.scene.node(mapping.node).type->find(mapping.inner->name) == mapping.inner);
}

TEST_CASE("sends the level of an LOD of a VRML97 text as in X3D") {
  const ReadMixed read("DEF L LOD { level Group { } } DEF S Switch { } ROUTE L.level_changed TO S.set_whichChoice");
  CHECK(read.diagnostics.errors() == 0);
  REQUIRE(read.scene.routes().size() == 1);
  CHECK(read.scene.routes()[0].event_out->type == FieldType::SFInt32);
}

TEST_CASE("gives a Script of a VRML97 text fields of X3D") {
  const ReadMixed read("Script { url \"javascript:\" load FALSE eventIn SFBool set_load field SFInt32 n 3 }");
  CHECK(read.diagnostics.errors() == 0);
  CHECK_FALSE(read.scene.get<SFBool>(read.root(), "load"));
  CHECK(read.scene.get<SFInt32>(read.root(), "n") == 3);
}

TEST_CASE("keeps IMPORT and EXPORT of a VRML97 text, with one warning each") {
  const ReadMixed read(
      "DEF I Inline { } DEF T Transform { } IMPORT I.a AS b\nIMPORT I.c\nEXPORT T AS t\n"
      "ROUTE b.scale TO T.scale");
  CHECK(read.said() == Lines{"text.wrl:2:38: warning: 'IMPORT' is a statement of X3D; read as in X3D",
                             "text.wrl:4:1: warning: 'EXPORT' is a statement of X3D; read as in X3D"});
  CHECK(read.scene.x3d().imports.size() == 2);
  CHECK(read.scene.x3d().exports.size() == 1);
  CHECK(read.scene.x3d().routes.size() == 1);
}

TEST_CASE("connects one interface of a Script to several of a PROTO") {
  const ReadMixed read(
      "PROTO P [ eventIn SFBool a eventIn SFBool b ] {\n"
      "  Script { eventIn SFBool x IS a eventIn SFBool x IS b }\n}\nP { }");
  CHECK(read.diagnostics.errors() == 0);
  CHECK(read.type().prototype->mappings.size() == 2);
}

TEST_CASE("knows fields that X3D 4 has renamed by both names") {
  for (const std::string name : {"color", "colorRamp"}) {
    INFO(name);
    SceneGraph scene("text.x3dv");
    Diagnostics diagnostics;
    (void)parse("#X3D V3.3 utf8\nParticleSystem { " + name + " ColorRGBA { } }\nLayer { isPickable FALSE }", scene,
                diagnostics);
    CHECK(diagnostics.errors() == 0);
    CHECK(scene.get<SFNode>(scene.roots()[0], "color"));
    CHECK_FALSE(scene.get<SFBool>(scene.roots()[1], "pickable"));
  }
}

TEST_CASE("prints nodes of a VRML97 text with fields of X3D in both languages") {
  const ReadMixed read("DEF A NavigationInfo { transitionTime 2 speed 3 } DEF B Box { size 1 2 3 solid FALSE }");
  const std::string x3d = printed_scene(read.scene, {Grammar::x3d_classic});
  for (const char* const part : {"\"WALK\"", "transitionTime", "solid FALSE", "speed 3"})
    CHECK(x3d.find(part) != std::string::npos);
  const std::string vrml97 = printed_scene(read.scene, {Grammar::vrml97});
  CHECK(vrml97.find("speed 3") != std::string::npos);
  for (const char* const part : {"solid", "type", "transition"}) CHECK(vrml97.find(part) == std::string::npos);
}

}  // namespace gs::vrml::traces
