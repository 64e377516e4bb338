#include "app/control/json_values.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

namespace gs::app::json_values_test {
namespace {

using vrml::FieldType;
using vrml::FieldValue;

std::optional<vrml::NodeId> read_node(JsonCursor& json, std::string& problem) {
  if (json.kind() == JsonKind::number) return vrml::NodeId{static_cast<std::uint32_t>(json.number()), 1};
  problem = "expected a node";
  return std::nullopt;
}

std::optional<FieldValue> read(std::string_view text, FieldType type, std::string* why = nullptr) {
  REQUIRE_FALSE(check_json(text));
  JsonCursor json(text);
  std::string problem;
  auto value = read_json_value(json, type, read_node, problem);
  CHECK(value.has_value() == problem.empty());
  if (why) *why = problem;
  return value;
}

std::string written(const FieldValue& value) {
  std::string out;
  append_json_value(out, value, [](std::string& to, vrml::NodeId node) { to += std::to_string(node.index); });
  CHECK_FALSE(check_json(out));
  return out;
}

/// Reads and writes a value. Returns an empty text if it is invalid.
std::string again(std::string_view text, FieldType type) {
  const auto value = read(text, type);
  if (!value) return {};
  CHECK(vrml::type_of(*value) == type);
  return written(*value);
}

std::string problem_of(std::string_view text, FieldType type) {
  std::string why;
  CHECK_FALSE(read(text, type, &why));
  return why;
}

}  // namespace

TEST_CASE("converts values of all twenty field types to JSON and back") {
  const std::pair<FieldType, const char*> values[] = {
      {FieldType::SFBool, "true"},
      {FieldType::SFColor, "[0.25,0.5,1]"},
      {FieldType::SFFloat, "-1.5"},
      {FieldType::SFImage, "[2,1,3,16711680,255]"},
      {FieldType::SFInt32, "-2147483648"},
      {FieldType::SFNode, "7"},
      {FieldType::SFRotation, "[0,1,0,1.57]"},
      {FieldType::SFString, "\"text\""},
      {FieldType::SFTime, "946684800.125"},
      {FieldType::SFVec2f, "[1,2]"},
      {FieldType::SFVec3f, "[1,2,3]"},
      {FieldType::MFColor, "[[0,0,1],[1,0,0]]"},
      {FieldType::MFFloat, "[1,2.5]"},
      {FieldType::MFInt32, "[0,1,-1]"},
      {FieldType::MFNode, "[3,null,4]"},
      {FieldType::MFRotation, "[[1,0,0,3]]"},
      {FieldType::MFString, "[\"a\",\"\"]"},
      {FieldType::MFTime, "[0,1.5]"},
      {FieldType::MFVec2f, "[[1,2],[3,4]]"},
      {FieldType::MFVec3f, "[[1,2,3],[4,5,6]]"},
      {FieldType::SFColorRGBA, "[0,0.5,1,0.25]"},
      {FieldType::SFDouble, "0.1"},
      {FieldType::SFMatrix3d, "[1,0,0,0,1,0,0.1,2,1]"},
      {FieldType::SFMatrix3f, "[1,0,0,0,1,0,0.1,2,1]"},
      {FieldType::SFMatrix4d, "[1,0,0,0,0,1,0,0,0,0,1,0,0.1,2,3,1]"},
      {FieldType::SFMatrix4f, "[1,0,0,0,0,1,0,0,0,0,1,0,0.1,2,3,1]"},
      {FieldType::SFVec2d, "[0.1,2]"},
      {FieldType::SFVec3d, "[0.1,2,3]"},
      {FieldType::SFVec4d, "[0.1,2,3,4]"},
      {FieldType::SFVec4f, "[0.1,2,3,4]"},
      {FieldType::MFBool, "[true,false]"},
      {FieldType::MFColorRGBA, "[[0,0.5,1,0.25],[1,1,1,1]]"},
      {FieldType::MFDouble, "[0.1,2]"},
      {FieldType::MFImage, "[[1,1,3,255],[0,0,0]]"},
      {FieldType::MFMatrix3d, "[[1,0,0,0,1,0,0.1,2,1]]"},
      {FieldType::MFMatrix3f, "[[1,0,0,0,1,0,0.1,2,1]]"},
      {FieldType::MFMatrix4d, "[[1,0,0,0,0,1,0,0,0,0,1,0,0.1,2,3,1]]"},
      {FieldType::MFMatrix4f, "[[1,0,0,0,0,1,0,0,0,0,1,0,0.1,2,3,1]]"},
      {FieldType::MFVec2d, "[[0.1,2],[3,4]]"},
      {FieldType::MFVec3d, "[[0.1,2,3]]"},
      {FieldType::MFVec4d, "[[0.1,2,3,4]]"},
      {FieldType::MFVec4f, "[[0.1,2,3,4]]"},
  };
  CHECK(std::size(values) == vrml::kFieldTypeCount);
  for (const auto& [type, text] : values) {
    INFO(vrml::name_of(type));
    CHECK(again(text, type) == text);
    if (vrml::is_multiple(type)) CHECK(again("[]", type) == "[]");
  }
  CHECK(again("null", FieldType::SFNode) == "null");
  CHECK(again("[0,0,0]", FieldType::SFImage) == "[0,0,0]");
}

TEST_CASE("accepts flat lists of vectors, colours and rotations") {
  CHECK(again("[1,2,3,4,5,6]", FieldType::MFVec3f) == "[[1,2,3],[4,5,6]]");
  CHECK(again("[1,2,3,4]", FieldType::MFVec2f) == "[[1,2],[3,4]]");
  CHECK(again("[1,2,3,4]", FieldType::MFRotation) == "[[1,2,3,4]]");
  CHECK(again("[0,0,1]", FieldType::MFColor) == "[[0,0,1]]");
  CHECK(problem_of("[1,2,3,4]", FieldType::MFVec3f) == "expected a multiple of 3 numbers");
  CHECK(problem_of("[1,2,3,[4,5,6]]", FieldType::MFVec3f) == "expected a number");
  CHECK(problem_of("[[1,2,3],4,5,6]", FieldType::MFVec3f) == "expected a list of 3 numbers");
}

TEST_CASE("refuses values of other types and invalid numbers, and names the expected type") {
  using Values = std::vector<std::pair<const char*, FieldType>>;
  const std::pair<const char*, Values> problems[] = {
      {"expected true or false", {{"1", FieldType::SFBool}}},
      {"expected a number", {{"\"1\"", FieldType::SFFloat}, {"\"NaN\"", FieldType::SFTime}}},
      {"expected a smaller number",
       {{"1e39", FieldType::SFFloat}, {"1e400", FieldType::SFTime}, {"[1,2,1e39]", FieldType::SFVec3f}}},
      {"expected a whole number from -2147483648 to 2147483647",
       {{"1.5", FieldType::SFInt32}, {"2147483648", FieldType::SFInt32}}},
      {"expected a list of 3 numbers",
       {{"[1,2]", FieldType::SFVec3f}, {"[1,2,3,4]", FieldType::SFVec3f}, {"{}", FieldType::SFVec3f}}},
      {"expected a string", {{"[1]", FieldType::SFString}, {"[1]", FieldType::MFString}}},
      {"expected a list", {{"\"a\"", FieldType::MFString}}},
      {"expected a node", {{"\"a\"", FieldType::SFNode}, {"[1,\"a\"]", FieldType::MFNode}}},
  };
  for (const auto& [problem, values] : problems)
    for (const auto& [text, type] : values) CHECK(problem_of(text, type) == problem);
}

TEST_CASE("requires as many pixels as an image claims, in as many bytes (VRML97 5.5)") {
  CHECK(problem_of("[2,1,1,5]", FieldType::SFImage) == "expected width, height, components and one number per pixel");
  CHECK(problem_of("[1,1,1,5,6]", FieldType::SFImage) == "expected one number per pixel");
  CHECK(problem_of("[1,1,5,6]", FieldType::SFImage) == "expected 0 to 4 components");
  CHECK(problem_of("[1,1,1,256]", FieldType::SFImage) == "expected a whole number from 0 to 255");
  CHECK(problem_of("[4294967295,4294967295,4]", FieldType::SFImage) ==
        "expected width, height, components and one number per pixel");
  CHECK(problem_of("[1,1]", FieldType::SFImage) == "expected width, height, components and one number per pixel");
  CHECK(again("[1,1,4,4294967295]", FieldType::SFImage) == "[1,1,4,4294967295]");
}

TEST_CASE("writes numbers that JSON lacks as strings") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  CHECK(written(FieldValue(vrml::SFVec3f(nan, infinity, -infinity))) == "[\"NaN\",\"Infinity\",\"-Infinity\"]");
  CHECK(written(FieldValue(vrml::SFString("\xff"))) == "\"\xef\xbf\xbd\"");
}

}  // namespace gs::app::json_values_test
