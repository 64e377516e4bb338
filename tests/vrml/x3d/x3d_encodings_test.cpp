#include "tests/vrml/x3d/read_world.h"
#include "vrml/scene/x3d/x3d_statements.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>

using namespace gs;
using namespace gs::vrml;
using gs::vrml::test::ReadWorld;

namespace {

/// Field type, its value in XML and in JSON, and its value in classic encoding.
struct Sample {
  const char *type, *xml, *json, *classic;
};
constexpr Sample kSamples[] = {
    {"SFBool", "true", "true", "TRUE"},
    {"MFBool", "true false", "[true,false]", "[ TRUE FALSE ]"},
    {"SFColor", "1 0 .5", "[1,0,0.5]", "1 0 .5"},
    {"MFColor", "1 0 0, 0 1 0", "[1,0,0,0,1,0]", "[ 1 0 0, 0 1 0 ]"},
    {"SFColorRGBA", "1 0 0 .5", "[1,0,0,0.5]", "1 0 0 .5"},
    {"MFColorRGBA", "1 0 0 .5 0 1 0 1", "[1,0,0,0.5,0,1,0,1]", "[ 1 0 0 .5 0 1 0 1 ]"},
    {"SFDouble", "1e300", "1e300", "1e300"},
    {"MFDouble", "0.1 2", "[0.1,2]", "[ 0.1 2 ]"},
    {"SFFloat", "1.5", "1.5", "1.5"},
    {"MFFloat", "1, 2 3", "[1,2,3]", "[ 1 2 3 ]"},
    {"SFImage", "2 1 3 0xff00ff 255", "[2,1,3,16711935,255]", "2 1 3 0xff00ff 255"},
    {"MFImage", "1 1 1 5 2 1 1 7 8", "[1,1,1,5,2,1,1,7,8]", "[ 1 1 1 5 2 1 1 7 8 ]"},
    {"SFInt32", "-5", "-5", "-5"},
    {"MFInt32", "1 -2 0x7f", "[1,-2,127]", "[ 1 -2 0x7f ]"},
    {"SFMatrix3f", "1 2 3 4 5 6 7 8 9", "[1,2,3,4,5,6,7,8,9]", "1 2 3 4 5 6 7 8 9"},
    {"MFMatrix3d", "1 2 3 4 5 6 7 8 9", "[1,2,3,4,5,6,7,8,9]", "[ 1 2 3 4 5 6 7 8 9 ]"},
    {"SFMatrix4d", "1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7", "[1,2,3,4,5,6,7,8,9,1,2,3,4,5,6,7]",
     "1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7"},
    {"SFRotation", "0 1 0 1.5", "[0,1,0,1.5]", "0 1 0 1.5"},
    {"MFRotation", "0 1 0 1", "[0,1,0,1]", "[ 0 1 0 1 ]"},
    {"SFString", "a &quot;b&quot;", "\"a \\\"b\\\"\"", "\"a \\\"b\\\"\""},
    {"MFString", "&quot;a&quot; &quot;b, c&quot;", "[\"a\",\"b, c\"]", "[ \"a\" \"b, c\" ]"},
    {"SFTime", "12345678.25", "12345678.25", "12345678.25"},
    {"MFTime", "1 2", "[1,2]", "[ 1 2 ]"},
    {"SFVec2d", "0.1 2", "[0.1,2]", "0.1 2"},
    {"SFVec2f", "1 2", "[1,2]", "1 2"},
    {"MFVec2f", "1 2 3 4", "[1,2,3,4]", "[ 1 2 3 4 ]"},
    {"SFVec3d", "0.1 2 3", "[0.1,2,3]", "0.1 2 3"},
    {"MFVec3f", "1 2 3", "[1,2,3]", "[ 1 2 3 ]"},
    {"SFVec4f", "1 2 3 4", "[1,2,3,4]", "1 2 3 4"},
    {"MFVec4d", "1 2 3 4", "[1,2,3,4]", "[ 1 2 3 4 ]"},
};

}  // namespace

TEST_CASE("reads values of all field types of X3D in XML and JSON") {
  std::string xml = "<X3D version='4.0'><Scene><Script>",
              json = R"({"X3D":{"@version":"4.0","Scene":{"-children":[{"Script":{"field":[)",
              classic = "#X3D V4.0 utf8\nScript {\n";
  for (std::size_t i = 0; i < std::size(kSamples); ++i) {
    const Sample& sample = kSamples[i];
    const std::string name = "f" + std::to_string(i), type = sample.type;
    xml += "<field name='" + name + "' type='" + type + "' accessType='initializeOnly' value='" + sample.xml + "'/>";
    json += std::string(i ? "," : "") + R"({"@name":")" + name + R"(","@type":")" + type +
            R"(","@accessType":"initializeOnly","@value":)" + sample.json + "}";
    classic += "initializeOnly " + type + " " + name + " " + sample.classic + "\n";
  }
  xml += "</Script></Scene></X3D>";
  json += "]}}]}}}";
  classic += "}\n";
  const ReadWorld from_xml(Grammar::x3d_xml, xml), from_json(Grammar::x3d_json, json),
      from_classic(Grammar::x3d_classic, classic);
  CHECK(from_xml.messages() == "");
  CHECK(from_json.messages() == "");
  CHECK(from_classic.messages() == "");
  CHECK(from_xml.text() == from_classic.text());
  CHECK(from_json.text() == from_classic.text());
}

TEST_CASE("reads the statements of X3D in XML and JSON") {
  const ReadWorld xml(Grammar::x3d_xml, R"(<X3D profile='Immersive' version='3.2'><head>
    <component name='Rendering' level='2'/><meta name='title' content='a.x3d'/>
    <unit category='length' name='mm' conversionFactor='0.001'/></head><Scene>
    <Inline DEF='I' url='"b.x3d"'/><IMPORT inlineDEF='I' importedDEF='X' AS='Y'/><Group DEF='G'/>
    <EXPORT localDEF='G' AS='H'/></Scene></X3D>)");
  const ReadWorld json(Grammar::x3d_json, R"({"X3D":{"@profile":"Immersive","@version":"3.2","head":{
    "component":[{"@name":"Rendering","@level":2}],"meta":[{"@name":"title","@content":"a.x3d"}],
    "unit":[{"@category":"length","@name":"mm","@conversionFactor":0.001}]},"Scene":{"-children":[
    {"Inline":{"@DEF":"I","@url":["b.x3d"]}},{"IMPORT":{"@inlineDEF":"I","@importedDEF":"X","@AS":"Y"}},
    {"Group":{"@DEF":"G"}},{"EXPORT":{"@localDEF":"G","@AS":"H"}}]}}})");
  for (const ReadWorld* world : {&xml, &json}) {
    const X3DStatements& x3d = world->scene.x3d();
    CHECK(world->diagnostics.errors() == 0);
    CHECK(world->scene.language() == Language::x3d);
    CHECK(world->scene.version() == 32);
    CHECK(x3d.profile == "Immersive");
    REQUIRE(x3d.components.size() == 1);
    CHECK(x3d.components[0].name == "Rendering");
    CHECK(x3d.components[0].level == 2);
    CHECK(x3d.meta("title") == "a.x3d");
    CHECK(x3d.unit("length") == 0.001);
    REQUIRE(x3d.imports.size() == 1);
    CHECK(x3d.imports[0].local == "Y");
    REQUIRE(x3d.exports.size() == 1);
    CHECK(x3d.exports[0].exported == "H");
  }
}
