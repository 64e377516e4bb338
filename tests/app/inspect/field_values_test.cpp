#include "app/inspect/field_values.h"

#include "vrml/scene/scene_graph.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>
#include <vector>

namespace gs::app::field_values_test {

Unit unit_of(const char* type, const char* field) {
  const vrml::NodeType* const of = vrml::built_in_node_type(type);
  REQUIRE(of);
  const vrml::InterfaceDeclaration* const one = of->find(field);
  REQUIRE(one);
  return app::unit_of(*of, *one);
}

// VRML97 4.4.5: lengths are metres, angles radians, times seconds.
TEST_CASE("shows fields in the units of the standard") {
  using Fields = std::vector<std::pair<const char*, const char*>>;
  const std::pair<Unit, Fields> units[] = {
      {Unit::metres,
       {{"Transform", "translation"}, {"ElevationGrid", "height"}, {"PlaneSensor", "translation_changed"}}},
      {Unit::radians, {{"Transform", "rotation"}, {"Viewpoint", "fieldOfView"}, {"CylinderSensor", "offset"}}},
      {Unit::seconds, {{"TimeSensor", "cycleInterval"}, {"TimeSensor", "cycleTime"}}},
      {Unit::metres_a_second, {{"NavigationInfo", "speed"}}},
      {Unit::none,
       {{"Transform", "scale"},
        {"TimeSensor", "fraction_changed"},
        {"MovieTexture", "speed"},
        {"PointLight", "attenuation"}}},
  };
  for (const auto& [unit, fields] : units)
    for (const auto& [type, field] : fields) CHECK(unit_of(type, field) == unit);
  CHECK(symbol_of(Unit::metres_a_second) == "m/s");
}

TEST_CASE("prints all 42 field types, and a longer text while they are edited") {
  vrml::SceneGraph scene("test.wrl");
  for (int i = 0; i < vrml::kFieldTypeCount; ++i) {
    const auto type = static_cast<vrml::FieldType>(i);
    INFO(vrml::name_of(type));
    const vrml::FieldValue value = vrml::initial_value(type);
    CHECK_FALSE(value_text(value, scene).empty());
    CHECK(editable_text(value, scene));
    CHECK(element_count(value) == (vrml::is_multiple(type) ? 0 : 1));
  }
  CHECK(value_text(vrml::SFVec3f(1, 2.5f, -3), scene) == "1 2.5 -3");
  CHECK(value_text(vrml::SFString("a\nb \"c\""), scene) == "\"a b \\\"c\\\"\"");
  CHECK(value_text(vrml::MFInt32{1, 2, 3}, scene) == "[ 1, 2, 3 ]");
}

TEST_CASE("shows only the beginning of long lists, strings and images") {
  vrml::SceneGraph scene("test.wrl");
  vrml::MFInt32 list;
  list.resize(3'000'000);
  const vrml::FieldValue value = list;
  CHECK(value_text(value, scene) == "[ 0, 0, 0, 0, 0, 0 ... ]");
  CHECK_FALSE(editable_text(value, scene));
  CHECK(element_count(value) == 3'000'000);
  const vrml::FieldValue text = vrml::SFString(std::string(100'000, 'x'));
  CHECK(value_text(text, scene).size() < 300);
  CHECK_FALSE(editable_text(text, scene));
  vrml::PixelImage image;
  image.words.resize(3 + 64 * 32);
  image.words.mutable_data()[0] = 64;
  image.words.mutable_data()[1] = 32;
  image.words.mutable_data()[2] = 3;
  CHECK(value_text(image, scene) == "64 x 32 pixels of 3 components");
  CHECK_FALSE(editable_text(image, scene));
}

TEST_CASE("shows the elements of lists as single values") {
  vrml::FieldValue list = vrml::MFVec2f{{1, 2}, {3, 4}};
  const vrml::FieldValue other = list;
  CHECK(element_of(list, 1) == vrml::FieldValue(vrml::SFVec2f(3, 4)));
  CHECK(set_element(list, 1, vrml::SFVec2f(5, 6)));
  CHECK(element_of(list, 1) == vrml::FieldValue(vrml::SFVec2f(5, 6)));
  CHECK(element_of(other, 1) == vrml::FieldValue(vrml::SFVec2f(3, 4)));
  CHECK_FALSE(set_element(list, 2, vrml::SFVec2f(0, 0)));
  CHECK_FALSE(set_element(list, 0, vrml::SFFloat(1)));
}

TEST_CASE("prints angles in degrees, and times as dates") {
  CHECK(degrees_text(1.5707963267948966) == "90 deg");
  CHECK(degrees_text(-0.7853981) == "-45 deg");
  CHECK(degrees_text(0.1) == "5.7 deg");
  CHECK(degrees_text(-1e-9) == "0 deg");
  CHECK(time_text(946684800.25) == "2000-01-01 00:00:00.25");
  CHECK(time_text(12.5) == "12.500");
  CHECK(time_text(-1) == "-1.000");
}

}  // namespace gs::app::field_values_test
