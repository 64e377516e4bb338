#include "vrml/xml/reader.h"

#include "tests/vrml/x3d/read_world.h"
#include "vrml/scene/scene_graph.h"

#include <catch2/catch.hpp>

#include <string>

using namespace gs;
using namespace gs::vrml;
using gs::vrml::test::printed_classic;
using gs::vrml::test::ReadWorld;

namespace {

std::string in_scene(const std::string& nodes) {
  return "<?xml version='1.0' encoding='UTF-8'?>\n<X3D profile='Immersive' version='3.3'><Scene>" + nodes +
         "</Scene></X3D>";
}

// Requires that XML and classic encoding give one world, without messages.
void check_equal(const std::string& nodes, const std::string& classic) {
  const ReadWorld world(Grammar::x3d_xml, in_scene(nodes));
  CHECK(world.messages() == "");
  CHECK(world.outcome == ParseOutcome::complete);
  CHECK(world.text() == printed_classic(classic));
}

std::string messages_of(const std::string& nodes) { return ReadWorld(Grammar::x3d_xml, in_scene(nodes)).messages(); }

const std::string kManyConstructs = in_scene(R"(
<WorldInfo title='a &lt; b &amp; c' info='"one" "two \"q\""'/> <!-- comment -- > -->
<Transform DEF='T' translation='1 2,3'><Shape DEF='S'><Box size='1 1 2'/>
  <Appearance><Material diffuseColor='1 0 0'/><ImageTexture url='"x.png" "y.png"'/></Appearance></Shape></Transform>
<Shape><IndexedFaceSet coordIndex='0 1 2 -1, 2 1 0 -1'><Coordinate point=')" +
                                             std::string(200, ' ') + R"(0 0 0, 1 0 0, 1 1 0
1 1 1'/></IndexedFaceSet></Shape>
<ProtoDeclare name='P'><ProtoInterface>
  <field accessType='inputOutput' name='c' type='SFColor' value='0 1 0'/>
  <field accessType='initializeOnly' name='kids' type='MFNode'><Group/></field></ProtoInterface>
 <ProtoBody><Shape><Appearance><Material><IS><connect nodeField='diffuseColor' protoField='c'/></IS></Material>
 </Appearance></Shape></ProtoBody></ProtoDeclare>
<ProtoInstance DEF='I' name='P'><fieldValue name='c' value='0 0 1'/></ProtoInstance>
<Script DEF='X'><field accessType='inputOnly' name='in' type='SFBool'/><![CDATA[
ecmascript: function in(v) { if (1 < 2 && v) print("x"); } ]]></Script>
<TouchSensor DEF='TS'/><ROUTE fromField='isActive' fromNode='TS' toField='in' toNode='X'/>)");

}  // namespace

TEST_CASE("reads nodes and fields of X3D in XML") {
  check_equal(R"(<Transform DEF='T' translation='1 2 3' rotation='0 1 0 .5'><Shape DEF='S'><Box size='1 1 2'/></Shape>
    <Shape USE='S'/></Transform>)",
              "DEF T Transform { rotation 0 1 0 .5 translation 1 2 3 children [ DEF S Shape { geometry Box { size 1 1 "
              "2 } } USE S ] }");
  check_equal(R"(<Viewpoint description='It&apos;s "here"' position='0 0 5' jump='false'/>)",
              "Viewpoint { description \"It's \\\"here\\\"\" position 0 0 5 jump FALSE }");
  check_equal("<Switch whichChoice='1'><Group/><Group/></Switch><LOD range='1, 2'><Group/></LOD>",
              "Switch { whichChoice 1 choice [ Group {} Group {} ] } LOD { range [ 1 2 ] level Group {} }");
  check_equal("<Shape><PointSet><Coordinate point='0 0 0 1 1 1'/><Color color='1 0 0,0 1 0'/></PointSet></Shape>",
              "Shape { geometry PointSet { coord Coordinate { point [ 0 0 0, 1 1 1 ] } color Color { color [ 1 0 0, 0 "
              "1 0 ] } } }");
  check_equal("<Shape><Appearance><PixelTexture image='2 1 3 0xff0000 255'/></Appearance></Shape>",
              "Shape { appearance Appearance { texture PixelTexture { image 2 1 3 0xff0000 255 } } }");
  check_equal("<Shape><Text string='\"a\" \"b, c\"'><FontStyle justify='\"MIDDLE\"' style='BOLD'/></Text></Shape>",
              "Shape { geometry Text { string [ \"a\", \"b, c\" ] fontStyle FontStyle { justify \"MIDDLE\" style "
              "\"BOLD\" } } }");
}

TEST_CASE("puts nodes with a missing or wrong containerField into the field that takes them") {
  check_equal("<Collision><Shape containerField='proxy'/><Group/></Collision>",
              "Collision { proxy Shape {} children Group {} }");
  check_equal("<Shape><Appearance containerField='children'/><Sphere/></Shape>",
              "Shape { appearance Appearance {} geometry Sphere {} }");
}

TEST_CASE("reads PROTO, instances and IS of X3D in XML") {
  check_equal(R"(<ProtoDeclare name='P'><ProtoInterface>
      <field name='c' type='SFColor' accessType='inputOutput' value='0 1 0'/>
      <field name='kids' type='MFNode' accessType='initializeOnly'><Group/></field>
      <field name='on' type='SFBool' accessType='inputOnly'/></ProtoInterface>
    <ProtoBody><Shape><Appearance><Material><IS><connect nodeField='diffuseColor' protoField='c'/></IS></Material>
      </Appearance></Shape></ProtoBody></ProtoDeclare>
    <ProtoInstance name='P' DEF='I'><fieldValue name='c' value='0 0 1'/><fieldValue name='kids'><Group/><Group/>
      </fieldValue></ProtoInstance>)",
              R"(PROTO P [ exposedField SFColor c 0 1 0 field MFNode kids Group {} eventIn SFBool on ] {
      Shape { appearance Appearance { material Material { diffuseColor IS c } } } }
    DEF I P { c 0 0 1 kids [ Group {} Group {} ] })");
  check_equal(
      R"(<ExternProtoDeclare name='E' url='"a.wrl#E" "b.wrl"'><field name='f' type='SFFloat' accessType='field'/>
    </ExternProtoDeclare><Shape><ProtoInstance name='E' containerField='geometry'/></Shape>)",
      R"(EXTERNPROTO E [ field SFFloat f ] [ "a.wrl#E" "b.wrl" ] Shape { geometry E {} })");
}

TEST_CASE("reads Scripts and ROUTEs of X3D in XML") {
  const ReadWorld world(Grammar::x3d_xml, kManyConstructs);
  CHECK(world.messages().empty());
  const std::string text = world.text();
  CHECK(text.find("url [ \"ecmascript: function in(v) { if (1 < 2 && v) print(\\\"x\\\"); }\" ]") != std::string::npos);
  CHECK(text.find("ROUTE TS.isActive TO X.in") != std::string::npos);
  CHECK(text.find("title \"a < b & c\"") != std::string::npos);
  CHECK(text.find("info [ \"one\", \"two \\\"q\\\"\" ]") != std::string::npos);
  CHECK(text.find("point [ 0 0 0, 1 0 0, 1 1 0, 1 1 1 ]") != std::string::npos);
  // IS before the declaration of the field.
  const ReadWorld late(Grammar::x3d_xml, in_scene(R"(<ProtoDeclare name='P'><ProtoInterface>
    <field name='a' type='SFFloat' accessType='inputOnly'/></ProtoInterface><ProtoBody><Script>
    <IS><connect nodeField='b' protoField='a'/></IS><field name='b' type='SFFloat' accessType='inputOnly'/></Script>
    </ProtoBody></ProtoDeclare>)"));
  CHECK(late.messages().empty());
  CHECK(late.text().find("inputOnly SFFloat b IS a") != std::string::npos);
}

TEST_CASE("reads XML in pieces of any size") { gs::vrml::test::check_pieces(Grammar::x3d_xml, kManyConstructs); }

TEST_CASE("tolerates habits of X3D files") {
  CHECK(messages_of("<Viewpoint jump='TRUE'/>") == "2:64: warning expected true or false, found 'TRUE'\n");
  CHECK(messages_of("<Inline url='a.wrl'/>").empty());
  CHECK(messages_of("<Shape class='c' id='i' xmlns:x='y' x:a='b'/>").empty());
  CHECK(messages_of("<Shape onclick='f()'/><Shape onclick='g()'/>") ==
        "2:63: warning Shape has no field 'onclick'; ignored\n");
  CHECK(messages_of("<Strange><Box/></Strange><Strange/><p>text</p>") ==
        "2:47: warning unknown node type 'Strange'; the node is skipped\n"
        "2:82: warning unknown element 'p'; skipped with its content\n");
  CHECK(messages_of("<Strange><Group DEF='G'/></Strange><Group USE='G'/>").find("error") == std::string::npos);
  CHECK(messages_of("<Transform translation='1 2'/>") == "2:71: error translation has 2 numbers; expected 3\n");
  CHECK(messages_of("<Transform translation='1 x 2'/>") ==
        "2:73: error expected a number for translation, found 'x'; 0 is used\n");
  CHECK(messages_of("<Group USE='no'/>") == "2:47: error USE of 'no', but no earlier DEF has this name\n");
}

TEST_CASE("reads encodings of XML") {
  const std::string body = "<X3D><Scene><WorldInfo title='caf\xc3\xa9'/></Scene></X3D>";
  const auto title = [](const std::string& text) {
    const ReadWorld world(Grammar::x3d_xml, text), bytes(Grammar::x3d_xml, text, 1);
    CHECK(world.text() == bytes.text());
    const std::string printed = world.text();
    const std::size_t at = printed.find('"');
    return at == std::string::npos ? world.messages() : printed.substr(at + 1, printed.find('"', at + 1) - at - 1);
  };
  std::string latin1 = body, little = "\xff\xfe", big = "\xfe\xff";
  latin1.replace(latin1.find("\xc3\xa9"), 2, "\xe9");
  for (const char c : latin1) {
    little += {c, '\0'};
    big += {'\0', c};
  }
  CHECK(title(body) == "caf\xc3\xa9");
  CHECK(title("\xef\xbb\xbf" + body) == "caf\xc3\xa9");
  CHECK(title("<?xml version='1.0' encoding='ISO-8859-1'?>" + latin1) == "caf\xc3\xa9");
  CHECK(title("<?xml version='1.0' encoding=\"windows-1252\"?>" + latin1) == "caf\xc3\xa9");
  CHECK(title(little) == "caf\xc3\xa9");
  CHECK(title(big) == "caf\xc3\xa9");
  CHECK(title(latin1) == "caf\xc3\xa9");
  CHECK(ReadWorld(Grammar::x3d_xml, latin1).messages() ==
        "1:13: warning the text is not UTF-8; read as windows-1252\n");
  CHECK(ReadWorld(Grammar::x3d_xml, "<?xml version='1.0' encoding='EUC-KR'?>" + body).messages() ==
        "1:1: warning the encoding 'euc-kr' is not supported; read as UTF-8\n");
  // The declaration ends at "?>": the quotes after it do not belong to its encoding.
  CHECK(ReadWorld(Grammar::x3d_xml, "\n\n\n\n<?xml encoding='x?>' ?>" + body).messages() ==
        ReadWorld(Grammar::x3d_xml, "\n\n\n\n<?xml encoding='x?>' ?>" + body, 1).messages());
}

TEST_CASE("shows everything before an error of XML") {
  const ReadWorld broken(Grammar::x3d_xml,
                         "<X3D><Scene>\n<Group DEF='A'/>\n<Group></Shape><Group DEF='B'/></Scene></X3D>");
  CHECK(broken.outcome == ParseOutcome::truncated);
  CHECK(broken.messages() == "3:8: error not well-formed XML: mismatched tag; skipped the rest of the file\n");
  CHECK(broken.text().find("DEF A Group {}") != std::string::npos);
  CHECK(broken.text().find('B') == std::string::npos);
  const ReadWorld cut(Grammar::x3d_xml, "<X3D><Scene><Group DEF='A'/><Shape");
  CHECK(cut.outcome == ParseOutcome::truncated);
  CHECK(cut.diagnostics.errors() == 1);
  CHECK(cut.text().find("DEF A Group {}") != std::string::npos);
}

TEST_CASE("reports tags that are not well-formed, plain or not") {
  const std::string token =
      "error not well-formed XML: not well-formed (invalid token); skipped the rest of the file\n";
  for (const char* const tag :
       {"<Group DEF 'a'/>", "<Group DEF=a/>", "<Group DEF='a'bboxSize='1 1 1'/>", "<Group DEF='a<b'/>", "<Group / >",
        "<Group/ DEF='a'>", "< Group/>", "<1Group/>", "<Group DEF='\x01'/>", "<Group =''/>", "<Group></Group x>",
        "<Group></ Group>", "<Group></Group/>", "<Group><>"}) {
    CAPTURE(tag);
    CHECK(messages_of(tag).find(token) != std::string::npos);
  }
  const auto fails = [](const std::string& tags, const std::string& problem) {
    CAPTURE(tags);
    CHECK(messages_of(tags).find("not well-formed XML: " + problem) != std::string::npos);
  };
  fails("<Group DEF='a' bboxSize='1 1 1' DEF='b'/>", "duplicate attribute");
  fails("<Group DEF='a' DEF='" + std::string(200, 'b') + "'/>", "duplicate attribute");
  fails("<Group><Shape></Group></Shape>", "mismatched tag");
  fails("<Group></Group ></Group>", "mismatched tag");
  fails("<G\xc3\xa9><Shape></G\xc3\xa9>", "mismatched tag");
  fails("<Group></G\xc3\xa9>", "mismatched tag");
  fails("<Group DEF='&none;'/>", "undefined entity");
  fails("<Script>a & <field/></Script>", "not well-formed (invalid token)");
  std::string many = "<Group";
  for (int i = 0; i < 40; ++i) many += " class" + std::to_string(i) + "='x'";
  CHECK(messages_of(many + "/>").find("error") == std::string::npos);
  fails(many + " class7='y'/>", "duplicate attribute");
}

TEST_CASE("reads plain tags with the results of other tags") {
  const std::string value = "'\"one\r\ntwo\" \t\n \"three\"'";
  const ReadWorld plain(Grammar::x3d_xml, in_scene("<WorldInfo\n\tDEF = 'W'\r\ninfo=" + value + "\n/>"));
  const ReadWorld other(Grammar::x3d_xml, in_scene("<WorldInfo\n\tDEF = '&#87;'\r\ninfo=" + value + "\n/>"));
  CHECK(plain.messages().empty());
  CHECK(plain.text() == other.text());
  CHECK(plain.text().find("\"one two\"") != std::string::npos);
  // A default value of the document type declaration, and tags in an entity.
  const std::string type = "<!DOCTYPE X3D [<!ATTLIST Box size CDATA '3 3 3'><!ENTITY part '<SphereSensor/>'>]>";
  const ReadWorld typed(Grammar::x3d_xml, type + in_scene("<Shape><Box/></Shape><Script>&part;</Script>"));
  CHECK(typed.text().find("size 3 3 3") != std::string::npos);
  CHECK(typed.messages().find("'SphereSensor' has no place here") != std::string::npos);
  // Positions of values in several lines.
  CHECK(
      messages_of("<Group>\n <Transform\n  translation='1 2 3'\n  rotation='0 0\n x 0'/></Group>\n<Group USE='no'/>") ==
      "5:18: error expected a number for rotation, found 'x'; 0 is used\n"
      "7:1: error USE of 'no', but no earlier DEF has this name\n");
}

TEST_CASE("refuses XML that is not X3D") {
  const ReadWorld other(Grammar::x3d_xml, "<html><X3D/></html>"), empty(Grammar::x3d_xml, "");
  CHECK(other.outcome == ParseOutcome::refused);
  CHECK(other.messages() == "1:1: error root element is 'html'; expected X3D\n");
  CHECK(empty.outcome == ParseOutcome::refused);
  CHECK(empty.diagnostics.errors() == 1);
}

TEST_CASE("bounds the expansion of entities and loads none") {
  const auto with = [](const std::string& subset, const std::string& title) {
    return ReadWorld(Grammar::x3d_xml,
                     "<!DOCTYPE X3D [" + subset + "]><X3D><Scene><WorldInfo title='" + title + "'/></Scene></X3D>");
  };
  CHECK(with("<!ENTITY a 'text'>", "&a;").text().find("title \"text\"") != std::string::npos);
  std::string laughs = "<!ENTITY a0 'lol'>";
  for (int i = 1; i <= 9; ++i) {
    laughs += "<!ENTITY a" + std::to_string(i) + " '";
    for (int j = 0; j < 10; ++j) laughs += "&a" + std::to_string(i - 1) + ";";
    laughs += "'>";
  }
  const ReadWorld laughed = with(laughs, "&a9;");
  CHECK(laughed.outcome == ParseOutcome::truncated);
  CHECK(laughed.diagnostics.errors() == 1);
  std::string many;
  for (int i = 0; i < 100000; ++i) many += "&a;";
  const ReadWorld quadratic = with("<!ENTITY a '" + std::string(100000, 'x') + "'>", many);
  CHECK(quadratic.diagnostics.errors() == 1);
  CHECK(with("<!ENTITY a SYSTEM 'file:///etc/passwd'>", "&a;").text().find("root") == std::string::npos);
  CHECK(ReadWorld(Grammar::x3d_xml,
                  "<!DOCTYPE X3D PUBLIC \"ISO//Web3D//DTD X3D 3.3//EN\" \"http://x.invalid/x3d.dtd\"><X3D/>")
            .messages()
            .empty());
}

TEST_CASE("bounds the depth and the memory of XML") {
  std::string deep = "<X3D><Scene>";
  for (int i = 0; i < 100000; ++i) deep += "<Group>";
  const ReadWorld nested(Grammar::x3d_xml, deep);
  CHECK(nested.outcome == ParseOutcome::truncated);
  CHECK(nested.diagnostics.errors() == 2);
  std::string names = "<X3D><Scene>";
  for (int i = 0; i < 200000; ++i) names += "<n" + std::to_string(i) + " a" + std::to_string(i) + "=''/>";
  Limits limits;
  limits.memory = 8u << 20;
  const ReadWorld flood(Grammar::x3d_xml, names, 0, limits);
  CHECK(flood.outcome == ParseOutcome::truncated);
  CHECK(flood.diagnostics.errors() == 1);
}
