#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>

#include <string>
#include <string_view>
#include <utility>

// Tests of the text of the field types that X3D adds to VRML97 (ISO/IEC 19776-2 5.x), as fields of a Script.
using namespace gs;
using namespace gs::vrml;

namespace {

std::string script_of(std::string_view type, std::string_view value) {
  return "#VRML V2.0 utf8\nDEF S Script { field " + std::string(type) + " x " + std::string(value) +
         " field SFInt32 last 7 }\n";
}

struct Read {
  SceneGraph scene{"test.wrl"};
  Diagnostics diagnostics;

  explicit Read(std::string_view text, bool in_pieces = false) {
    if (in_pieces) {
      Parser parser(scene, diagnostics);
      for (const char& letter : text) parser.push({&letter, 1});
      (void)parser.finish();
    } else {
      (void)parse(text, scene, diagnostics);
    }
  }
  // Returns the text of the field x, or the first error.
  [[nodiscard]] std::string value() const {
    if (!diagnostics.entries().empty()) return diagnostics.entries().front().message;
    std::string text;
    const Node& script = scene.node(scene.roots()[0]);
    print_value(text, script.values[script.type->find_field("x")->slot], scene);
    if (script.values[script.type->find_field("last")->slot] != FieldValue(SFInt32{7})) text += " and no last field";
    return text;
  }
};

constexpr std::pair<std::string_view, std::string_view> kValues[] = {
    {"SFColorRGBA", "0 0.5 1 0.25"},
    {"SFDouble", "0.1234567890123456"},
    {"SFMatrix3d", "1 0 0 0 1 0 0.1234567890123456 2 1"},
    {"SFMatrix3f", "1 2 3 4 5 6 7 8 9.5"},
    {"SFMatrix4d", "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 0.1234567890123456"},
    {"SFMatrix4f", "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16.5"},
    {"SFVec2d", "0.1234567890123456 1e+300"},
    {"SFVec3d", "0.1234567890123456 -2 3"},
    {"SFVec4d", "0.1234567890123456 -2 3 4"},
    {"SFVec4f", "0.1 -2 3 4"},
    {"MFBool", "[ TRUE, FALSE, TRUE ]"},
    {"MFColorRGBA", "[ 0 0.5 1 0.25, 1 1 1 1 ]"},
    {"MFDouble", "[ 0.1234567890123456, 2 ]"},
    {"MFImage", "[ 2 1 3 0xff0000 0xff, 0 0 0, 1 2 1 0x0 0x80 ]"},
    {"MFMatrix3d", "[ 1 0 0 0 1 0 0.1234567890123456 2 1, 1 2 3 4 5 6 7 8 9 ]"},
    {"MFMatrix3f", "[ 1 2 3 4 5 6 7 8 9.5, 1 2 3 4 5 6 7 8 9 ]"},
    {"MFMatrix4d", "[ 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 0.1234567890123456 ]"},
    {"MFMatrix4f", "[ 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16.5, 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 ]"},
    {"MFVec2d", "[ 0.1234567890123456 1e+300, 1 2 ]"},
    {"MFVec3d", "[ 0.1234567890123456 -2 3, 4 5 6 ]"},
    {"MFVec4d", "[ 0.1234567890123456 -2 3 4, 5 6 7 8 ]"},
    {"MFVec4f", "[ 0.1 -2 3 4, 5 6 7 8 ]"},
};

}  // namespace

TEST_CASE("reads and prints the field types of X3D, whole and byte by byte") {
  for (const auto& [type, value] : kValues) {
    INFO(type);
    const Read whole(script_of(type, value));
    CHECK(whole.value() == value);
    CHECK(Read(script_of(type, value), true).value() == value);
    CHECK(Read(print(whole.scene)).value() == value);
    if (type.starts_with("MF")) CHECK(Read(script_of(type, "[]")).value() == "[ ]");
  }
}

TEST_CASE("reads commas and single elements without brackets in the field types of X3D") {
  CHECK(Read(script_of("SFMatrix3f", "1, 2, 3, 4, 5, 6, 7, 8, 9")).value() == "1 2 3 4 5 6 7 8 9");
  CHECK(Read(script_of("MFVec4d", "1 2 3 4")).value() == "[ 1 2 3 4 ]");
  CHECK(Read(script_of("MFBool", "TRUE")).value() == "[ TRUE ]");
  CHECK(Read(script_of("MFMatrix3d", "1 2 3 4 5 6 7 8 9")).value() == "[ 1 2 3 4 5 6 7 8 9 ]");
  for (const bool in_pieces : {false, true})
    CHECK(Read(script_of("MFImage", "2 1 1 5 6"), in_pieces).value() == "[ 2 1 1 0x5 0x6 ]");
}

TEST_CASE("reports incomplete values of the field types of X3D, and continues") {
  const auto problem = [](std::string_view type, std::string_view value) {
    const Read read(script_of(type, value));
    CHECK(read.diagnostics.entries().size() == 1);
    CHECK(read.scene.node(read.scene.roots()[0]).type->find_field("last"));
    return read.value();
  };
  CHECK(problem("SFMatrix3f", "1 2 3") == "expected SFMatrix3f for x, found 'field'");
  CHECK(problem("MFVec3d", "[ 1 2 3 4 ]") == "the last value of x has 1 numbers; expected 3");
  CHECK(problem("MFBool", "[ TRUE, maybe ]") == "expected Bool or ']' in x, found 'maybe'");
  CHECK(problem("MFImage", "[ 1 1 1 5, \"a\" ]") == "expected Image or ']' in x, found a string");
  CHECK(problem("MFImage", "\"a\"") == "expected SFImage for x, found a string");
  CHECK(problem("MFImage", "[ 1 1 7 5 ]") ==
        "an image of 1 x 1 pixels with 7 components; expected 0 to 4 components and at most 268435456 pixels");
}
