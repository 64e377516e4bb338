#include "vrml/json/reader.h"

#include "tests/vrml/x3d/read_world.h"
#include "vrml/json/list_reader.h"

#include <catch2/catch.hpp>

#include <string>

using namespace gs;
using namespace gs::vrml;
using gs::vrml::test::printed_classic;
using gs::vrml::test::ReadWorld;

namespace {

std::string json_in_scene(const std::string& nodes) {
  return R"({"X3D":{"encoding":"UTF-8","@profile":"Immersive","@version":"3.3","JSON schema":"x",
"head":{"#comment":"none"},"Scene":{"-children":[)" +
         nodes + "]}}}";
}

// Requires that JSON and classic encoding give one world, without messages.
void json_check_equal(const std::string& nodes, const std::string& classic) {
  const ReadWorld world(Grammar::x3d_json, json_in_scene(nodes));
  CHECK(world.messages() == "");
  CHECK(world.outcome == ParseOutcome::complete);
  CHECK(world.text() == printed_classic(classic));
}

std::string json_messages_of(const std::string& nodes) {
  return ReadWorld(Grammar::x3d_json, json_in_scene(nodes)).messages();
}

const std::string kManyMembers = json_in_scene(R"(
{"WorldInfo":{"@title":"caf\u00e9 \ud83d\ude00","@info":["one","two \"q\"\n"]}}, {"#comment":"no {node}"},
{"Transform":{"@DEF":"T","@translation":[1,2.5e0,-3],"-children":[{"Shape":{"-geometry":{"Box":{"@size":[1,1,2]}}}}]}},
{"Shape":{"-geometry":{"IndexedFaceSet":{"@coordIndex":[0,1,2,-1],"@solid":false,
  "-coord":{"Coordinate":{"@point":[0,0,0,1,0,0,
1,1,0]}}}}}},
{"ProtoDeclare":{"@name":"P","ProtoInterface":{"field":[
  {"@accessType":"inputOutput","@name":"c","@type":"SFColor","@value":[0,1,0]},
  {"@accessType":"initializeOnly","@name":"kids","@type":"MFNode","-children":[{"Group":{}}]}]},
 "ProtoBody":{"-children":[{"Shape":{"-appearance":{"Appearance":{"-material":{"Material":{
   "IS":{"connect":[{"@nodeField":"diffuseColor","@protoField":"c"}]}}}}}}}]}}},
{"ProtoInstance":{"@DEF":"I","@name":"P","fieldValue":[{"@name":"c","@value":[0,0,1]}]}},
{"Script":{"@DEF":"X","field":[{"@accessType":"inputOnly","@name":"in","@type":"SFBool"}],
  "#sourceCode":["ecmascript:","function in(v) { print(1 < 2); }"]}},
{"TouchSensor":{"@DEF":"TS"}},
{"ROUTE":{"@fromField":"isActive","@fromNode":"TS","@toField":"in","@toNode":"X"}})");

}  // namespace

TEST_CASE("reads nodes and fields of X3D in JSON") {
  json_check_equal(
      R"({"Transform":{"@DEF":"T","@translation":[1,2,3],"-children":[{"Shape":{"@DEF":"S","-geometry":
    {"Box":{"@size":[1,1,2]}}}},{"Shape":{"@USE":"S"}}]}})",
      "DEF T Transform { translation 1 2 3 children [ DEF S Shape { geometry Box { size 1 1 2 } } USE S ] }");
  json_check_equal(
      R"({"Switch":{"@whichChoice":1,"-children":[{"Group":{}},{"Group":{}}]}},{"NavigationInfo":{"@type":["FLY","ANY"],"@headlight":false}})",
      R"(Switch { whichChoice 1 choice [ Group {} Group {} ] } NavigationInfo { type [ "FLY" "ANY" ] headlight FALSE })");
  json_check_equal(
      R"({"Shape":{"-appearance":{"Appearance":{"-texture":{"PixelTexture":{"@image":[2,1,3,16711680,4294967295]}}}}}})",
      "Shape { appearance Appearance { texture PixelTexture { image 2 1 3 0xff0000 0xffffff } } }");
  json_check_equal(R"({"Viewpoint":{"@description":"a \"b\" \\ \/ \u0041","@position":[0,0,5]}})",
                   "Viewpoint { description \"a \\\"b\\\" \\\\ / A\" position 0 0 5 }");
}

TEST_CASE("reads PROTO, Scripts and ROUTEs of X3D in JSON") {
  const ReadWorld world(Grammar::x3d_json, kManyMembers);
  CHECK(world.messages().empty());
  const std::string text = world.text();
  CHECK(text.find("diffuseColor IS c") != std::string::npos);
  CHECK(text.find("DEF I P { c 0 0 1 }") != std::string::npos);
  CHECK(text.find("url [ \"ecmascript:\nfunction in(v) { print(1 < 2); }\" ]") != std::string::npos);
  CHECK(text.find("ROUTE TS.isActive TO X.in") != std::string::npos);
  CHECK(text.find("title \"caf\xc3\xa9 \xf0\x9f\x98\x80\"") != std::string::npos);
  CHECK(text.find("point [ 0 0 0, 1 0 0, 1 1 0 ]") != std::string::npos);
}

TEST_CASE("reads JSON in pieces of any size") { gs::vrml::test::check_pieces(Grammar::x3d_json, kManyMembers); }

TEST_CASE("reads members of JSON in any order") {
  json_check_equal(
      R"({"Transform":{"-children":[{"Group":{}}],"@translation":[1,2,3],"@DEF":"T"}},{"Transform":{"@USE":"T"}})",
      "DEF T Transform { translation 1 2 3 children Group {} } USE T");
  json_check_equal(R"({"ProtoDeclare":{
      "ProtoBody":{"-children":[{"Transform":{"IS":{"connect":[{"@protoField":"t","@nodeField":"translation"}]}}}]},
      "ProtoInterface":{"field":[{"@value":[1,2,3],"@type":"SFVec3f","@name":"t","@accessType":"inputOutput"}]},
      "@name":"P"}},
    {"ProtoInstance":{"fieldValue":[{"@value":[4,5,6],"@name":"t"}],"@name":"P"}})",
                   "PROTO P [ exposedField SFVec3f t 1 2 3 ] { Transform { translation IS t } } P { t 4 5 6 }");
}

TEST_CASE("tolerates habits of X3D in JSON") {
  json_check_equal(R"({"Transform":{"@translation":"1 2 3","@scale":[["2",2],[2]],}})",
                   "Transform { translation 1 2 3 scale 2 2 2 }");
  json_check_equal(R"({"Shape":{"-geometry":null,"@bboxSize":null,"unknown":1}})", "Shape {}");
  json_check_equal(R"({"Inline":{"@url":"a.wrl"}})", "Inline { url \"a.wrl\" }");
  CHECK(json_messages_of(R"({"Transform":{"@translation":[1,2]}})") ==
        "2:79: error translation has 2 numbers; expected 3\n");
  CHECK(json_messages_of(R"({"Transform":{"@translation":[1,x,2]}})") ==
        "2:82: error expected a number for translation, found 'x'; 0 is used\n");
}

TEST_CASE("names a field that JSON gives twice, even if its name was in an earlier piece") {
  gs::vrml::test::check_pieces(Grammar::x3d_json,
                               json_in_scene(R"({"Transform":{"@translation":[1,2,3],"@translation":[4,5,6]}})"));
}

TEST_CASE("clamps large numbers of integer fields in JSON to 32 bits") {
  const ReadWorld world(Grammar::x3d_json,
                        json_in_scene(R"({"Switch":{"@whichChoice":1e300}},{"Switch":{"@whichChoice":-1e300}},
    {"Switch":{"@whichChoice":4294967295}})"));
  CHECK(world.text() ==
        printed_classic("Switch { whichChoice 2147483647 } Switch { whichChoice -2147483648 } Switch {}"));
}

TEST_CASE("reports JSON that ends too early or is not X3D") {
  const ReadWorld cut(Grammar::x3d_json, R"({"X3D":{"Scene":{"-children":[{"Group":{"@DEF":"A"}},{"Shape":{"-geo)");
  CHECK(cut.outcome == ParseOutcome::truncated);
  CHECK(cut.diagnostics.errors() == 1);
  CHECK(cut.text().find("DEF A Group {}") != std::string::npos);
  CHECK(ReadWorld(Grammar::x3d_json, "{\"a\": 1}").outcome == ParseOutcome::refused);
  CHECK(ReadWorld(Grammar::x3d_json, "").outcome == ParseOutcome::refused);
  std::string deep = R"({"X3D":{"Scene":)";
  for (int i = 0; i < 100000; ++i) deep += R"({"-children":[{"Group":)";
  const ReadWorld nested(Grammar::x3d_json, deep);
  CHECK(nested.outcome == ParseOutcome::truncated);
  CHECK(nested.diagnostics.errors() == 2);
}

TEST_CASE("decodes the strings of JSON") {
  bool latin1 = false;
  CHECK(json::decode_string(R"(a\t\"\\\/\b\u00e9\q\u12)", true, latin1) == "a\t\"\\/\b\xc3\xa9\\q\\u12");
  CHECK(json::decode_string(R"(\ud800x\udc00)", true, latin1) == "\xef\xbf\xbdx\xef\xbf\xbd");
  CHECK(!latin1);
  CHECK(json::decode_string("\xe9", false, latin1) == "\xc3\xa9");
  CHECK(latin1);
}
