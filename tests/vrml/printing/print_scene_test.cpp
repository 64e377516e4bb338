#include "vrml/printing/print_scene.h"

#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml::print_scene_test {
namespace {

std::unique_ptr<SceneGraph> scene_of(const std::string& text) {
  auto scene = std::make_unique<SceneGraph>("printed.wrl");
  Diagnostics diagnostics;
  (void)parse(text, *scene, diagnostics);
  for (const Diagnostic& d : diagnostics.entries()) UNSCOPED_INFO(d.text());
  CHECK(diagnostics.errors() == 0);
  return scene;
}

std::unique_ptr<SceneGraph> world(const std::string& body) { return scene_of("#VRML V2.0 utf8\n" + body); }

// Returns the text of a scene from the first node on, without the lines around the nodes.
std::string nodes_of(const std::string& text, std::string_view begin, std::string_view end) {
  const std::size_t from = text.find(begin), to = text.rfind(end);
  REQUIRE(from != std::string::npos);
  REQUIRE(to != std::string::npos);
  return text.substr(from + begin.size(), to - from - begin.size());
}

std::string xml(const std::string& body) {
  return nodes_of(printed_scene(*world(body), {Grammar::x3d_xml}), "<Scene>", "\n  </Scene>");
}

std::string json(const std::string& body) {
  return nodes_of(printed_scene(*world(body), {Grammar::x3d_json}), "\"-children\": [", "\n    ]\n  }\n} }");
}

std::string classic(const std::string& body) {
  const std::string text = printed_scene(*world(body), {Grammar::x3d_classic});
  return text.substr(text.find("\n\n", text.find("PROFILE")) + 2);
}

constexpr const char* kBall =
    "DEF Ball Transform { translation 1 2 0.5 children Shape { appearance Appearance { material Material { "
    "diffuseColor "
    "1 0 0 } } geometry Sphere { radius 2 } } }\nDEF Clock TimeSensor { loop TRUE }\n"
    "DEF Way PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1 ] }\n"
    "ROUTE Clock.fraction_changed TO Way.set_fraction\nROUTE Way.value_changed TO Ball.translation\n";

}  // namespace

TEST_CASE("prints a VRML97 scene in the three encodings of X3D") {
  CHECK(xml(kBall) == R"(
    <Transform DEF='Ball' translation='1 2 0.5'>
      <Shape>
        <Appearance>
          <Material diffuseColor='1 0 0'/>
        </Appearance>
        <Sphere radius='2'/>
      </Shape>
    </Transform>
    <TimeSensor DEF='Clock' loop='true'/>
    <PositionInterpolator DEF='Way' key='0 1' keyValue='0 0 0, 1 1 1'/>
    <ROUTE fromNode='Clock' fromField='fraction_changed' toNode='Way' toField='set_fraction'/>
    <ROUTE fromNode='Way' fromField='value_changed' toNode='Ball' toField='translation'/>)");
  CHECK(
      json("DEF Ball Transform { translation 1 2 0.5 children [ DEF S Shape { geometry Sphere { radius 2 } } USE S ] } "
           "TimeSensor { loop TRUE }") == R"(
      { "Transform": {
        "@DEF": "Ball",
        "-children": [
          { "Shape": {
            "@DEF": "S",
            "-geometry": { "Sphere": {
              "@radius": 2
            } }
          } },
          { "Shape": {
            "@USE": "S"
          } }
        ],
        "@translation": [1,2,0.5]
      } },
      { "TimeSensor": {
        "@loop": true
      } })");
  CHECK(classic("Switch { choice Group { } whichChoice 0 }") == "Switch {\n  children Group {}\n  whichChoice 0\n}\n");
}

TEST_CASE("gives X3D texts the names of X3D") {
  CHECK(xml("Switch { choice Group { } whichChoice 0 }") ==
        "\n    <Switch whichChoice='0'>\n      <Group/>\n    </Switch>");
  CHECK(xml("Collision { collide FALSE proxy Shape { } }") ==
        "\n    <Collision enabled='false'>\n      <Shape containerField='proxy'/>\n    </Collision>");
  CHECK(xml("LOD { level [ Group { } Group { } ] range 5 }") ==
        "\n    <LOD range='5'>\n      <Group/>\n      <Group/>\n    </LOD>");
  // Defaults differ: VRML97 walks, X3D examines.
  CHECK(xml("NavigationInfo { }") == "\n    <NavigationInfo type='\"WALK\", \"ANY\"'/>");
  CHECK(xml("NavigationInfo { type [ \"EXAMINE\", \"ANY\" ] }") == "\n    <NavigationInfo/>");
}

TEST_CASE("states the smallest profile with the components of the nodes") {
  const auto head = [](const std::string& body) {
    const std::string text = printed_scene(*world(body), {Grammar::x3d_classic});
    return text.substr(text.find("PROFILE"), text.find("\n\n", text.find("PROFILE")) - text.find("PROFILE"));
  };
  CHECK(head("Shape { geometry Box { } }") == "PROFILE Interchange");
  CHECK(head("TouchSensor { }") == "PROFILE Interactive");
  CHECK(head("Billboard { }") == "PROFILE Immersive");
  CHECK(head("Script { }") == "PROFILE Immersive");
  CHECK(head("PROTO P [ ] { Group { } }") == "PROFILE Immersive");
  CHECK(
      printed_scene(*world("Group { }"), {Grammar::x3d_classic}).starts_with("#X3D V3.3 utf8\n\nPROFILE Interchange"));
}

TEST_CASE("escapes texts by the rules of each encoding") {
  const std::string body =
      "WorldInfo { title \"<a> & 'b' \\\"c\\\" \\\\ d\te\" info [ \"say \\\"x\\\" \\\\\", \"two\" ] }";
  CHECK(xml(body) ==
        "\n    <WorldInfo info='\"say \\\"x\\\" \\\\\", \"two\"' title='&lt;a> &amp; &apos;b&apos; \"c\" \\ d&#9;e'/>");
  CHECK(json(body) == R"(
      { "WorldInfo": {
        "@info": ["say \"x\" \\", "two"],
        "@title": "<a> & 'b' \"c\" \\ d\te"
      } })");
  // XML has no control characters.
  PrintOptions options{Grammar::x3d_xml};
  std::string text;
  const auto losses = print_scene(*world("WorldInfo { title \"a\x01z\" }"), options, [&](std::string_view piece) {
    text += piece;
    return true;
  });
  CHECK(text.find("title='az'") != std::string::npos);
}

TEST_CASE("writes programs of Scripts as text of the element, with the scheme of X3D") {
  const std::string body =
      "DEF S Script { eventIn SFBool on eventOut SFTime now field SFNode self USE S field MFString words [ \"a\", "
      "\"b\" ] "
      "url \"javascript:\nfunction on(v) { if (v < 1 && v > 0) now = 0; }\" }";
  CHECK(xml(body) == R"(
    <Script DEF='S'>
      <field accessType='inputOnly' type='SFBool' name='on'/>
      <field accessType='outputOnly' type='SFTime' name='now'/>
      <field accessType='initializeOnly' type='SFNode' name='self'>
        <Script USE='S'/>
      </field>
      <field accessType='initializeOnly' type='MFString' name='words' value='"a", "b"'/>
      <![CDATA[ecmascript:
function on(v) { if (v < 1 && v > 0) now = 0; }]]>
    </Script>)");
  CHECK(xml("Script { url [ \"a.js\", \"vrmlscript:x\" ] }") == "\n    <Script url='\"a.js\", \"ecmascript:x\"'/>");
  CHECK(xml("Script { url \"javascript:a[b[0]]>1\" }").find("<![CDATA[ecmascript:a[b[0]]]]><![CDATA[>1]]>") !=
        std::string::npos);
  CHECK(json("Script { url \"javascript:\none\ntwo\" }").find("\"#sourceCode\": [\n          \"ecmascript:\",\n") !=
        std::string::npos);
}

TEST_CASE("writes PROTOs, their connections and their instances") {
  const std::string body =
      "PROTO Lamp [ exposedField SFVec3f at 1 0 0 field MFNode parts [ ] eventIn SFBool set_on field SFNode look "
      "Group { } ] {\n  Transform { translation IS at children IS parts }\n  DEF L PointLight { set_on IS set_on }\n}\n"
      "EXTERNPROTO Far [ field SFFloat x ] [ \"far.wrl#Far\" ]\n"
      "DEF A Lamp { at 2 0 0 parts [ Shape { } ] }\nUSE A\nShape { geometry Far { x 2 } }";
  CHECK(nodes_of(printed_scene(*scene_of("#VRML V2.0 utf8\n" + body), {Grammar::x3d_xml}), "<Scene>", "\n  </Scene>") ==
        R"(
    <ProtoDeclare name='Lamp'>
      <ProtoInterface>
        <field accessType='inputOutput' type='SFVec3f' name='at' value='1 0 0'/>
        <field accessType='initializeOnly' type='MFNode' name='parts'/>
        <field accessType='inputOnly' type='SFBool' name='set_on'/>
        <field accessType='initializeOnly' type='SFNode' name='look'>
          <Group DEF='_Group'/>
        </field>
      </ProtoInterface>
      <ProtoBody>
        <Transform>
          <IS>
            <connect nodeField='children' protoField='parts'/>
            <connect nodeField='translation' protoField='at'/>
          </IS>
        </Transform>
        <PointLight DEF='L'>
          <IS>
            <connect nodeField='on' protoField='set_on'/>
          </IS>
        </PointLight>
      </ProtoBody>
    </ProtoDeclare>
    <ExternProtoDeclare name='Far' url='"far.wrl#Far"'>
      <field accessType='initializeOnly' type='SFFloat' name='x'/>
    </ExternProtoDeclare>
    <ProtoInstance name='Lamp' DEF='A'>
      <fieldValue name='at' value='2 0 0'/>
      <fieldValue name='parts'>
        <Shape/>
      </fieldValue>
    </ProtoInstance>
    <ProtoInstance name='Lamp' USE='A'/>
    <Shape>
      <ProtoInstance name='Far' containerField='geometry'>
        <fieldValue name='x' value='2'/>
      </ProtoInstance>
    </Shape>)");
  CHECK(
      classic(
          "PROTO P [ exposedField SFFloat a 1 eventOut SFTime t field SFInt32 n 2 eventIn SFBool b ] { Group { } }") ==
      "PROTO P [\n  inputOutput SFFloat a 1\n  outputOnly SFTime t\n  initializeOnly SFInt32 n 2\n  inputOnly SFBool "
      "b\n"
      "] {\n  Group {}\n}\n");
}

TEST_CASE("writes instances of a PROTO that is a fallback for a built-in node") {
  const std::string text =
      xml("PROTO QNV [ exposedField MFString url [ ] ] { PointSet { } }\n"
          "Shape { geometry QNV { url \"a.qnv\" } }");
  CHECK(text.find("<ProtoInstance name='QNV' containerField='geometry'>") != std::string::npos);
  CHECK(text.find("<fieldValue name='url' value='\"a.qnv\"'/>") != std::string::npos);
}

TEST_CASE("writes images, empty lists and numbers without loss") {
  CHECK(xml("Shape { appearance Appearance { texture PixelTexture { image 2 1 3 0xFF0000 0x00FF00 } } }")
            .find("<PixelTexture image='2 1 3 0xff0000 0xff00'/>") != std::string::npos);
  CHECK(json("PixelTexture { image 1 2 1 0x80 255 }").find("\"@image\": [1,2,1,128,255]") != std::string::npos);
  CHECK(xml("NavigationInfo { type [ ] avatarSize [ 0.1 1e-10 1234567.8 ] }") ==
        "\n    <NavigationInfo avatarSize='0.1 1e-10 1234567.8' type=''/>");
}

TEST_CASE("prints NaN without a sign, which differs between processors") {
  SceneGraph scene;
  const NodeId node = scene.create(*built_in_node_type("Transform"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  scene.set(node, "translation", SFVec3f{std::copysign(nan, -1.0f), nan, -1});
  scene.add_root(node);
  CHECK(printed_scene(scene, {Grammar::vrml97}).find("translation nan nan -1") != std::string::npos);
}

TEST_CASE("adapts the URLs of all url fields") {
  PrintOptions options{Grammar::vrml97};
  options.moved_urls = [](const MFString& urls) -> std::optional<MFString> {
    MFString moved;
    for (const String& url : urls) moved.push_back(String("up/" + url.str()));
    return urls.empty() ? std::nullopt : std::optional(std::move(moved));
  };
  const std::string text = printed_scene(*world("Inline { url \"a.wrl\" }\nPROTO P [ field MFString lowUrl \"low.wrl\" "
                                                "field MFString words \"a\" ] { Group { "
                                                "} }\nBackground { backUrl \"b.png\" }"),
                                         options);
  CHECK(text.find("url [ \"up/a.wrl\" ]") != std::string::npos);
  CHECK(text.find("lowUrl [ \"up/low.wrl\" ]") != std::string::npos);
  CHECK(text.find("words [ \"a\" ]") != std::string::npos);
  CHECK(text.find("backUrl [ \"up/b.png\" ]") != std::string::npos);
}

}  // namespace gs::vrml::print_scene_test
