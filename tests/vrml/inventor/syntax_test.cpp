#include "tests/vrml/inventor/converted.h"

using namespace gs;
using namespace gs::vrml;
using namespace gs::vrml::test;

namespace {

/// World that uses most parts of the syntax.
const std::string kWorld = kInventor + R"(
DEF Root+1 Separator { # a comment with a brace }
  Info { string "a \"quoted\" } brace" }
  DEF M Material { diffuseColor [ 1 0 0, 0 1 0 ] transparency 0.5 ~ }
  Translation { translation 0 0 0 = Compose3 { x 1 } . vector }
  Wheel { fields [ SFFloat radius, MFNode spokes ] isA [ "Rim", "Group" ] radius 2 spokes [ Cube { }, USE M ] Sphere { } }
  Unknown { size 1 2 3 name "x" Cone { } }
  ShapeKit { appearance AppearanceKit { material Material { diffuseColor 0 0 1 } }
    shape Cylinder { parts (SIDES | TOP) }
    callbackList NodeKitListPart { containerTypeName "Separator" childTypes "Callback" containerNode Separator { } } }
  Coordinate3 { point [ 0 0 0, 1 0 0, 1 1 0, ] }
  IndexedFaceSet { coordIndex [ 0, 1, 2, -1 ] materialIndex 0x1 }
  USE Root+0
}
DEF Last Texture2 { image 1 2 1 0xff 0x10 filename plain.rgb }
USE Last
)";

}  // namespace

TEST_CASE("reads connections, ignored fields, own fields, nodekits and unknown nodes") {
  const Converted world(kWorld);
  INFO(world.messages());
  const std::string text = print(world.scene);
  for (const char* shape : {"Sphere", "Cone", "IndexedFaceSet", "WorldInfo"}) {
    INFO(shape);
    CHECK(text.find(shape) != std::string::npos);
  }
  CHECK(text.find("a \\\"quoted\\\" } brace") != std::string::npos);
  CHECK(text.find("transparency") == std::string::npos);  // ignored
  CHECK(world.outcome == ParseOutcome::complete);
  CHECK(world.diagnostics.errors() == 1);  // USE Root+0
  for (const char* words : {"connections of fields", "'Unknown'", "string has no quotes", "USE of 'Root+0'"}) {
    INFO(words);
    CHECK(world.says(words));
  }
}

TEST_CASE("gives the same scene for pieces of any size") {
  const Converted whole(kWorld);
  for (std::size_t piece = 1; piece < 80; ++piece) {
    const Converted pieces(kWorld, piece);
    CHECK(print(pieces.scene) == print(whole.scene));
    CHECK(pieces.messages() == whole.messages());
  }
}

TEST_CASE("shows the part that was received, and reports the end once") {
  for (std::size_t size = 0; size < kWorld.size(); ++size) {
    const Converted cut(kWorld.substr(0, size));
    std::size_t ends = 0;
    for (const Diagnostic& one : cut.diagnostics.entries())
      if (one.message.find("the file ends inside") != std::string::npos) ++ends;
    CHECK(ends <= 1);
  }
  const Converted cut(kVrml1 + "Separator { Cube { width 3 } Material { diffuseColor [ 1 0");
  CHECK(cut.outcome == ParseOutcome::truncated);
  CHECK(cut.says("world.wrl:2:"));
  CHECK(print(cut.scene).find("size 3 2 2") != std::string::npos);
}

TEST_CASE("continues after errors at the next field or node") {
  const Converted world(kVrml1 +
                        "Separator {\n  Cube { width wide height 4 }\n  Sphere { bulk 3 radius 2 }\n"
                        "  Coordinate3 { point [ 0 0 0, 1 x 0 0 ] }\n  ] Cone { } }\n} Cube { }");
  INFO(world.messages());
  CHECK(world.says("world.wrl:3:16: error: expected a number for width, found 'wide'"));
  CHECK(world.says("world.wrl:4:12: warning: Sphere has no field 'bulk'; skipped"));
  const std::string text = print(world.scene);
  CHECK(text.find("size 2 4 2") != std::string::npos);
  CHECK(text.find("radius 2") != std::string::npos);
  CHECK(text.find("Cone") != std::string::npos);
}

TEST_CASE("refuses binary Inventor with a remedy") {
  const Converted world("#Inventor V2.1 binary\n\x01\x02");
  CHECK(world.outcome == ParseOutcome::refused);
  CHECK(world.says("binary Inventor cannot be read; convert it to ASCII"));
}

TEST_CASE("limits nesting and images") {
  std::string deep = kVrml1;
  for (int i = 0; i < 5000; ++i) deep += "Separator { Cube { } ";
  CHECK(Converted(deep).says("nested deeper than"));
  CHECK(Converted(kVrml1 + "Texture2 { image 100000 100000 3 0 }").diagnostics.errors() == 1);
  Limits few;
  few.nodes = 10;
  std::string cubes = kVrml1;
  for (int i = 0; i < 100; ++i) cubes += "Cube { width " + std::to_string(i + 1) + " }\n";
  CHECK(Converted(cubes, 64, few).says("more than 10 nodes"));
}

TEST_CASE("reports each unsupported type once") {
  const Converted world(kInventor + "Separator { TrackballDragger { } TrackballDragger { } ElapsedTime { } }");
  std::size_t draggers = 0;
  for (const Diagnostic& one : world.diagnostics.entries())
    if (one.message.find("draggers") != std::string::npos) ++draggers;
  CHECK(draggers == 1);
  CHECK(world.says("ElapsedTime: engines are not supported"));
}
