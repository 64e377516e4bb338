#include "tests/vrml/x3d/read_world.h"

#include <catch2/catch.hpp>

#include <string>

// Texts with many parts of one kind. A reader with quadratic work needs minutes for each of them. The tests count the
// memory that a text draws from the budget, and the messages.

using namespace gs;
using namespace gs::vrml;
using gs::vrml::test::ReadWorld;

namespace {

constexpr std::size_t kMany = 80'000;

std::string repeated(const std::string& text, std::size_t count) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t mark = text.find('$');
    all += text.substr(0, mark);
    if (mark != std::string::npos) all += std::to_string(i) + text.substr(mark + 1);
  }
  return all;
}

std::string joined(const std::string& text, std::size_t count) {
  std::string all = repeated(text + ',', count);
  all.pop_back();
  return all;
}

std::string in_xml(const std::string& nodes) {
  return "<X3D profile='Full' version='4.0'><Scene>" + nodes + "</Scene></X3D>";
}
std::string in_json(const std::string& nodes) {
  return R"({"X3D":{"@profile":"Full","@version":"4.0","Scene":{"-children":[)" + nodes + "]}}}";
}

// Reads a text with a number of parts and with four times as many. Requires that the memory grows at most as the text,
// and that few messages are made. `text_of` returns the text with a number of parts.
template <class TextOf>
void check_growth(Grammar grammar, const TextOf& text_of) {
  const std::string less_text = text_of(kMany / 4), more_text = text_of(kMany);
  const ReadWorld less(grammar, less_text), more(grammar, more_text);
  CAPTURE(less_text.substr(0, 120));
  CHECK(more.scene.memory().charged() <= 5 * less.scene.memory().charged());
  CHECK(more.scene.memory().charged() < 100 * more_text.size());
  CHECK(more.diagnostics.entries().size() <= 1100);
}

void check_xml(const std::string& before, const std::string& part, const std::string& after) {
  check_growth(Grammar::x3d_xml, [&](std::size_t n) { return in_xml(before + repeated(part, n) + after); });
}
void check_json(const std::string& before, const std::string& part, const std::string& after) {
  check_growth(Grammar::x3d_json, [&](std::size_t n) { return in_json(before + joined(part, n) + after); });
}

}  // namespace

TEST_CASE("takes time in proportion to a hostile text of X3D in XML") {
  check_xml("<Group ", "a$='1' ", "/>");
  check_xml("<Group ", "a$='&lt;' ", "/>");
  check_xml("<Group DEF='a' ", "DEF='a' ", "/>");
  check_xml("", "<Group DEF='n$'/>", "");
  check_xml("", "<T$/>", "");
  check_xml("<BooleanSequencer keyValue='", "true ", "'/>");
  check_xml("<BooleanSequencer keyValue='", "TRUE\n", "'/>");
  check_xml("<WorldInfo info='", "\"a\" ", "'/>");
  check_xml("<IndexedFaceSet coordIndex='", "1.5 ", "'/>");
  check_xml("<Script><field name='f' type='MFImage' accessType='initializeOnly' value='", "1 1 1 5 ", "'/></Script>");
  check_xml("<Script>", "<field name='f$' type='SFBool' accessType='inputOutput'/>", "</Script>");
  check_xml("<Script>", "<![CDATA[a]]>b<!-- -->", "</Script>");
  check_xml("<ProtoDeclare name='P'><ProtoInterface>", "<field name='f$' type='SFBool' accessType='inputOutput'/>",
            "</ProtoInterface><ProtoBody><Group/></ProtoBody></ProtoDeclare>");
  check_xml("<Group>", "<ProtoDeclare name='P$'><ProtoBody><Group/></ProtoBody></ProtoDeclare>", "</Group>");
  check_xml("", "<Group>", "");
}

TEST_CASE("takes time in proportion to a hostile text of X3D in JSON") {
  check_json(R"({"Group":{)", R"("@a$":1)", "}}");
  check_json(R"({"ROUTE":{)", R"("@a$":1)", "}}");
  check_json("", R"({"Group":{"@DEF":"n$"}})", "");
  check_json("", R"({"T$":{}})", "");
  check_json(R"({"WorldInfo":{"@info":[)", R"("a")", "]}}");
  check_json(R"({"Coordinate":{)", R"("@point":[1,2,3])", "}}");
  check_json(R"({"Script":{"field":[)", R"({"@name":"f$","@type":"SFBool","@accessType":"inputOutput"})", "]}}");
  check_growth(Grammar::x3d_json, [](std::size_t n) {
    return in_json(R"({"Script":{"field":{)" + joined(R"("@a$":1)", n) + ',' + joined(R"("@value":1)", n) +
                   R"(,"@name":"f"}}})");
  });
  check_growth(Grammar::x3d_json, [](std::size_t n) { return in_json(repeated(R"({"Group":{"-children":[)", n)); });
}

TEST_CASE("takes time in proportion to a hostile text of VRML97") {
  const auto check = [](const std::string& before, const std::string& part, const std::string& after) {
    check_growth(Grammar::vrml97,
                 [&](std::size_t n) { return "#VRML V2.0 utf8\n" + before + repeated(part, n) + after; });
  };
  check("PROTO P [", "field SFBool f$ TRUE\n", "] { Group {} }");
  check("Script {", "field SFBool f$ TRUE\n", "}");
  check("PROTO P [ field SFBool f TRUE ] { Script {", "field SFBool f$ IS f\n", "} }");
  check("", "DEF n$ Group {}\n", "");
  check("Group { children [", "PROTO P$ [] { Group {} }\n", "] }");
}
