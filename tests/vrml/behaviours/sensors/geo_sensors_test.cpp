#include "tests/vrml/events/pointer.h"
#include "vrml/scene/coordinates/geospatial.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cstdlib>
#include <string>

// Tests of GeoProximitySensor and GeoTouchSensor (X3D 25.3.8, 25.3.10).
namespace gs::vrml::traces {
namespace {

constexpr double kEquator = 6378137;

glm::dmat4 viewer_above_equator(double height, double east = 0) {
  return glm::translate(glm::dmat4(1), {kEquator + height, east, 0});
}

// Returns the numbers of the last line of the trace that contains `event`.
std::vector<double> numbers_of(const Lines& lines, const std::string& event) {
  std::vector<double> numbers;
  for (const std::string& line : lines) {
    const std::size_t at = line.find(event);
    if (at == std::string::npos) continue;
    numbers.clear();
    const char* text = line.c_str() + at + event.size();
    for (char* end = nullptr;; text = end) {
      const double number = std::strtod(text, &end);
      if (end == text) break;
      numbers.push_back(number);
    }
  }
  return numbers;
}

}  // namespace

TEST_CASE("reports entry, movement and exit of the viewer by a GeoProximitySensor (X3D 25.3.8)") {
  X3DWorld world("DEF P GeoProximitySensor { geoCenter 0 0 1000 size 400 400 400 }");
  world.execution().viewer().set(viewer_above_equator(2000));
  world.start();
  CHECK(world.take_at(1).empty());
  world.execution().viewer().set(viewer_above_equator(1100));
  const Lines entered = world.take_at(2);
  REQUIRE(entered.size() == 5);
  CHECK(entered[0] == "2 P.isActive TRUE");
  CHECK(entered[1].substr(0, 13) == "2 P.enterTime");
  CHECK(numbers_of(entered, "enterTime")[0] == Approx(1001 + 800.0 / 900));
  CHECK(numbers_of(entered, "position_changed")[0] == Approx(kEquator + 1100));
  CHECK(numbers_of(entered, "geoCoord_changed")[2] == Approx(1100));
  // A movement of a centimetre is less than the resolution of an SFVec3f.
  world.execution().viewer().set(viewer_above_equator(1100, 0.01));
  const Lines moved = world.take_at(3);
  REQUIRE(moved.size() == 2);
  CHECK(numbers_of(moved, "geoCoord_changed")[1] == Approx(0.01 / kEquator * 180 / 3.14159265358979).epsilon(1e-3));
  CHECK(world.take_at(4).empty());
  world.execution().viewer().set(viewer_above_equator(3000));
  const Lines left = world.take_at(5);
  CHECK(left[0] == "5 P.isActive FALSE");
  CHECK(left[1].substr(0, 12) == "5 P.exitTime");
}

TEST_CASE("moves the box of a GeoProximitySensor with geoCenter, center and its GeoOrigin") {
  X3DWorld world(
      "DEF P GeoProximitySensor { geoSystem [ \"UTM\" \"Z31\" ] geoCenter 5411932 448251 35 size 20 20 20 "
      "geoOrigin GeoOrigin { geoSystem [ \"UTM\" \"Z31\" ] geoCoords 5411932 448251 35 rotateYUp TRUE } }");
  world.execution().viewer().set(glm::translate(glm::dmat4(1), {0, 1, 0}));
  world.start();
  const Lines entered = world.take_at(1);
  const std::vector<double> coordinates = numbers_of(entered, "geoCoord_changed");
  REQUIRE(coordinates.size() == 3);
  CHECK(coordinates[0] == Approx(5411932).margin(1e-3));
  CHECK(coordinates[1] == Approx(448251).margin(1e-3));
  CHECK(coordinates[2] == Approx(36).margin(1e-3));
  CHECK(numbers_of(entered, "P.position_changed")[1] == Approx(1).margin(1e-6));
  world.send("P.center", SFVec3d(glm::dvec3(0, 50, 0)));
  CHECK(world.take("isActive") == Lines{"1 P.isActive FALSE"});
  world.step(2);
  world.send("P.geoCenter", SFVec3d(glm::dvec3(5411932, 448251, -15)));
  CHECK(world.take("isActive") == Lines{"2 P.isActive TRUE"});
  world.step(3);
  world.send("P.enabled", SFBool{false});
  CHECK(world.take("isActive") == Lines{"3 P.isActive FALSE"});
}

TEST_CASE("lets a GeoProximitySensor rest while the viewer is far from it") {
  X3DWorld world("DEF P GeoProximitySensor { geoCenter 0 0 1000 size 400 400 400 }");
  world.execution().viewer().set(viewer_above_equator(2000));
  world.start();
  for (int i = 1; i < 5; ++i) world.step(i);
  CHECK(world.execution().viewer().idle().count() == 1);
  world.execution().viewer().set(viewer_above_equator(1000));
  CHECK(world.take_at(6, "isActive") == Lines{"6 P.isActive TRUE"});
}

TEST_CASE("sends geospatial coordinates of the hit point from a GeoTouchSensor (X3D 25.3.10)") {
  X3DWorld world(
      "Transform { translation 100 0 0 children [ DEF T GeoTouchSensor { geoOrigin DEF O GeoOrigin { geoCoords 48 11 "
      "500 "
      "rotateYUp TRUE } } DEF S Shape { geometry Box { } } ] }");
  world.start();
  PointingDevice device(world);
  device.move("S", 100, 0);
  const Lines lines = world.take();
  const std::vector<double> coordinates = numbers_of(lines, "hitGeoCoord_changed");
  REQUIRE(coordinates.size() == 3);
  CHECK(coordinates[0] == Approx(48).margin(1e-9));
  CHECK(coordinates[1] == Approx(11).margin(1e-9));
  CHECK(coordinates[2] == Approx(500).margin(1e-6));
  world.step(1);
  device.move("S", 101, 2);
  const std::vector<double> moved = numbers_of(world.take(), "hitGeoCoord_changed");
  REQUIRE(moved.size() == 3);
  CHECK(moved[1] > 11);
  CHECK(moved[2] == Approx(502).margin(1e-3));
}

TEST_CASE("keeps geospatial sensors silent for coordinates that are not finite") {
  X3DWorld world(
      "DEF P GeoProximitySensor { geoCenter 1e300 1e300 1e300 size 1 1 1 } "
      "DEF Q GeoProximitySensor { geoSystem \"GC\" size 1e9 1e9 1e9 }");
  world.execution().viewer().set(glm::dmat4(1));
  world.start();
  CHECK(world.take_at(1, "P.").empty());
  CHECK(numbers_of(world.take_at(2), "Q.geoCoord_changed").empty());
  world.execution().viewer().set(viewer_above_equator(1));
  CHECK(numbers_of(world.take_at(3), "Q.geoCoord_changed")[0] == Approx(kEquator + 1));
}

}  // namespace gs::vrml::traces
