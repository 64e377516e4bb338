#include "app/inspect/field_edits.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <limits>
#include <string>

namespace gs::app::field_edits_test {

struct Editor {
  LoadedWorld world = world_of("DEF A Group {} DEF B Group {}");
  vrml::NodeNames names{*world.scene};

  // Returns the valid value, or the error.
  std::variant<vrml::FieldValue, std::string> edit(const char* type, const char* event_in, const std::string& text) {
    const vrml::NodeType* const of = vrml::built_in_node_type(type);
    REQUIRE(of);
    const vrml::InterfaceDeclaration* const one = of->find_event_in(event_in);
    REQUIRE(one);
    return read_edit(*of, *one, text, names);
  }
  bool fine(const char* type, const char* event_in, const std::string& text) {
    return std::holds_alternative<vrml::FieldValue>(edit(type, event_in, text));
  }
  std::string why(const char* type, const char* event_in, const std::string& text) {
    const auto read = edit(type, event_in, text);
    return std::holds_alternative<std::string>(read) ? std::get<std::string>(read) : "";
  }
};

// VRML97 4.7.
TEST_CASE("edits exactly the fields that an event can set") {
  const auto setter = [](const char* type, const char* field) {
    const vrml::NodeType& of = *vrml::built_in_node_type(type);
    const vrml::InterfaceDeclaration* const found = setter_of(of, *of.find(field));
    return found ? found->name : "";
  };
  CHECK(setter("Transform", "translation") == "translation");
  CHECK(setter("IndexedFaceSet", "coordIndex") == "set_coordIndex");
  CHECK(setter("Group", "addChildren") == "addChildren");
  CHECK(setter("Box", "size").empty());
  CHECK(setter("TimeSensor", "isActive").empty());
  const vrml::NodeType& box = *vrml::built_in_node_type("Box");
  CHECK(why_not_set(*box.find("size")).find("without an eventIn") != std::string::npos);
}

TEST_CASE("finds the field that keeps the value of an event") {
  const auto field = [](const char* type, const char* event_in) {
    const vrml::NodeType& of = *vrml::built_in_node_type(type);
    const vrml::InterfaceDeclaration* const found = field_set_by(of, *of.find(event_in));
    return found ? found->name : "";
  };
  CHECK(field("Transform", "translation") == "translation");
  CHECK(field("Transform", "addChildren") == "");
  CHECK(field("ElevationGrid", "set_height") == "height");
  CHECK(field("Viewpoint", "set_bind") == "");
}

TEST_CASE("parses a text to a value of the field's type, or reports why not") {
  Editor editor;
  CHECK(editor.edit("Transform", "translation", "1 2 3") ==
        std::variant<vrml::FieldValue, std::string>(vrml::FieldValue(vrml::SFVec3f(1, 2, 3))));
  CHECK(editor.why("Transform", "translation", "1 2") == "'1 2' is no SFVec3f");
  CHECK(editor.why("Transform", "translation", "1 2 3 ] field SFInt32 x 1").find("is no SFVec3f") != std::string::npos);
  CHECK(editor.fine("Text", "string", "[ \"a\", \"b\" ]"));
  CHECK(editor.fine("Group", "children", "[ A B ]"));
  CHECK(editor.why("Group", "children", "[ C ]").find("expected DEF names") != std::string::npos);
  CHECK(editor.fine("Shape", "geometry", "NULL"));
}

// The ranges of VRML97 clause 6, as printed in the interfaces.
TEST_CASE("reports the expected range for a value outside it") {
  Editor editor;
  CHECK(editor.fine("Material", "transparency", "1"));
  CHECK(editor.why("Material", "transparency", "1.5") == "1.5 is out of range; expected at least 0 and at most 1");
  CHECK(editor.why("Transform", "scale", "1 0 1") == "0 is out of range; expected more than 0");
  CHECK(editor.fine("Viewpoint", "fieldOfView", "1"));
  CHECK(editor.why("Viewpoint", "fieldOfView", "0") == "0 is out of range; expected more than 0");
  CHECK(editor.why("SpotLight", "beamWidth", "0") == "0 is out of range; expected more than 0 and at most pi/2");
  CHECK(editor.why("PointLight", "color", "1 2 0") == "2 is out of range; expected at least 0 and at most 1");
  CHECK(editor.why("Color", "color", "[ 0 0 0, 0 -1 0 ]").starts_with("element 2: -1 is out of range"));
  // A field x with an eventIn set_x.
  CHECK(editor.fine("IndexedFaceSet", "set_coordIndex", "[ 0, 1, 2, -1 ]"));
  CHECK(editor.why("IndexedFaceSet", "set_coordIndex", "[ 0, -2 ]") ==
        "element 2: -2 is out of range; expected at least -1");
  // The second range of a rotation is that of the angle. The axis must not be 0 (5.8).
  CHECK(editor.fine("Transform", "rotation", "0 3 0 12"));
  CHECK(editor.why("Transform", "rotation", "0 0 0 1").find("not an axis") != std::string::npos);
  CHECK(editor.fine("Transform", "rotation", "0 0 0 0"));
}

TEST_CASE("refuses invalid numbers and values of other types") {
  const vrml::NodeType& transform = *vrml::built_in_node_type("Transform");
  const vrml::InterfaceDeclaration& translation = *transform.find("translation");
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN(), kFar = std::numeric_limits<float>::infinity();
  CHECK(why_not_valid(transform, translation, vrml::SFVec3f(0, kNone, 0)) == "expected finite numbers");
  CHECK(why_not_valid(transform, translation, vrml::SFVec3f(kFar, 0, 0)) == "expected finite numbers");
  CHECK(why_not_valid(transform, translation, vrml::SFFloat(1)) == "expected a value of type SFVec3f");
  CHECK_FALSE(why_not_valid(transform, translation, vrml::SFVec3f(1, 2, 3)));
}

// Parses each range of the node table, so that none is skipped.
TEST_CASE("prints defaults within the ranges that it prints") {
  std::size_t ranges = 0;
  for (const auto& type : vrml::built_in_node_types())
    for (const vrml::InterfaceDeclaration& one : type->interfaces) {
      if (one.slot < 0 || one.range.empty()) continue;
      ++ranges;
      INFO(type->name << "." << one.name << " " << one.range);
      CHECK(why_not_valid(*type, one, one.initial).value_or("") == "");
    }
  CHECK(ranges > 100);
}

}  // namespace gs::app::field_edits_test
