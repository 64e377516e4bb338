#include "tests/vrml/events/trace.h"

#include <cmath>
#include <string>

namespace gs::vrml::traces {
namespace {

struct InterpolatorRow {
  const char* type;
  const char* values;      // for keys 1 and 3
  const char* at_first;    // for the first key and before it
  const char* in_between;  // for 2
  const char* at_last;
};

const InterpolatorRow kInterpolatorRows[] = {
    {"ColorInterpolator", "[ 1 0 0, 1 1 0 ]", "1 0 0", "1 0.5 0", "1 1 0"},
    {"CoordinateInterpolator", "[ 0 0 0, 1 1 1, 2 0 0, 3 1 1 ]", "[ 0 0 0, 1 1 1 ]", "[ 1 0 0, 2 1 1 ]",
     "[ 2 0 0, 3 1 1 ]"},
    {"NormalInterpolator", "[ 1 0 0, 0 1 0 ]", "[ 1 0 0 ]", nullptr, "[ 0 1 0 ]"},
    {"OrientationInterpolator", "[ 0 1 0 0, 0 1 0 1 ]", "0 1 0 0", "0 1 0 0.5", "0 1 0 1"},
    {"PositionInterpolator", "[ 0 0 0, 2 4 6 ]", "0 0 0", "1 2 3", "2 4 6"},
    {"ScalarInterpolator", "[ 10 20 ]", "10", "15", "20"},
};

std::string value_sent(World& world, double at, float fraction) {
  world.send_at(at, "I.set_fraction", SFFloat{fraction});
  const Lines lines = world.take();
  if (lines.size() != 1) return "events: " + std::to_string(lines.size());
  const std::string start = std::to_string(static_cast<int>(at)) + " I.value_changed ";
  return lines[0].starts_with(start) ? lines[0].substr(start.size()) : lines[0];
}

}  // namespace

TEST_CASE("sends one value_changed per set_fraction from each of the six interpolators, with its timestamp (4.6.8)") {
  for (const InterpolatorRow& row : kInterpolatorRows) {
    INFO(row.type);
    World world("DEF I " + std::string(row.type) + " { key [ 1 3 ] keyValue " + row.values + " }");
    world.start();
    CHECK(world.take().empty());
    CHECK(value_sent(world, 1, 1) == row.at_first);
    CHECK(value_sent(world, 2, 0) == row.at_first);
    CHECK(value_sent(world, 3, -1e30F) == row.at_first);
    CHECK(value_sent(world, 4, 3) == row.at_last);
    CHECK(value_sent(world, 5, 1e30F) == row.at_last);
    if (row.in_between) CHECK(value_sent(world, 6, 2) == row.in_between);
    CHECK(value_sent(world, 7, 1) == row.at_first);
  }
}

TEST_CASE("sends key_changed and keyValue_changed, and uses new keys from the next set_fraction (4.6.8)") {
  for (const InterpolatorRow& row : kInterpolatorRows) {
    INFO(row.type);
    World world("DEF I " + std::string(row.type) + " { key [ 1 3 ] keyValue " + row.values + " }");
    world.start();
    CHECK(value_sent(world, 1, 2.5F) != row.at_last);
    world.send("I.set_key", MFFloat{1, 2});
    CHECK(world.take() == Lines{"1 I.key [ 1, 2 ]"});
    CHECK(value_sent(world, 2, 2.5F) == row.at_last);
  }
}

TEST_CASE("applies set_fraction and set_key of one cascade in the order of their events (4.6.8, 4.10.3)") {
  World world(R"(
DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 10 ] } DEF A ScalarInterpolator { key 0 keyValue 0 }
DEF B ScalarInterpolator { } ROUTE B.keyValue TO I.keyValue ROUTE A.value_changed TO I.set_fraction)");
  world.start();
  world.send("B.keyValue", MFFloat{20, 40});
  world.send("A.keyValue", MFFloat{0.5F});
  world.send("A.set_fraction", SFFloat{0});
  CHECK(world.take("I.value_changed") == Lines{"0 I.value_changed 30"});
}

TEST_CASE("sends nothing from an interpolator before its first set_fraction (4.6.8)") {
  World world("DEF I ScalarInterpolator { key [ 0 1 ] keyValue [ 0 10 ] }");
  world.start();
  world.send_at(1, "I.keyValue", MFFloat{20, 40});
  CHECK(world.take_at(2, "value_changed").empty());
}

TEST_CASE("sends unit vectors from a NormalInterpolator, with equal arcs for equal fractions (6.31)") {
  World world(
      "DEF I NormalInterpolator { key [ 0 1 ] keyValue [ 1 0 0, 0 0 1, 0 1 0, 0 1 0 ] } DEF N Normal { } "
      "ROUTE I.value_changed TO N.vector");
  world.start();
  for (int i = 1; i < 9; ++i) {
    world.send_at(i, "I.set_fraction", SFFloat{static_cast<float>(i) / 9});
    const auto& normals = world.scene().get<MFVec3f>(world.node("N"), "vector");
    REQUIRE(normals.size() == 2);
    const double angle = i * 10 * 3.14159265358979 / 180;
    CHECK(normals[0].x == Approx(std::cos(angle)).margin(1e-6));
    CHECK(normals[0].y == Approx(std::sin(angle)).margin(1e-6));
    CHECK(normals[1].z == Approx(std::cos(angle)).margin(1e-6));
  }
}

TEST_CASE("takes the shorter arc in an OrientationInterpolator if the keys are over half a turn apart (6.32)") {
  World world(
      "DEF I OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 5 ] } DEF T Transform { } "
      "ROUTE I.value_changed TO T.rotation");
  world.start();
  world.send("I.set_fraction", SFFloat{0.5F});
  const auto& turn = world.scene().get<SFRotation>(world.node("T"), "rotation");
  // Halfway from 2 pi to 5.
  CHECK(std::cos(turn.y * turn.angle) == Approx(std::cos((2 * 3.14159265 + 5) / 2)).margin(1e-6));
  CHECK(std::sin(turn.y * turn.angle) == Approx(std::sin((2 * 3.14159265 + 5) / 2)).margin(1e-6));
}

TEST_CASE("interpolates hues the shorter way round, also through 0 (6.10)") {
  World world("DEF I ColorInterpolator { key [ 0 1 ] keyValue [ 1 0 0.5, 1 0.5 0 ] }");
  world.start();
  CHECK(value_sent(world, 1, 0.5F) == "1 0 0");
}

TEST_CASE("sends positions on the curve of a NurbsPositionInterpolator (Amendment 1)") {
  const std::string curve =
      "DEF I NurbsPositionInterpolator { order 3 knot [ 0 0 0 2 2 2 ] keyValue [ 0 0 0, 2 0 0, 2 2 0 ] } ";
  World alone(curve);
  alone.start();
  CHECK(value_sent(alone, 1, 0) == "0 0 0");
  CHECK(value_sent(alone, 2, 0.5F) == "1.5 0.5 0");
  CHECK(value_sent(alone, 3, 1) == "2 2 0");
  CHECK(value_sent(alone, 4, -7) == "0 0 0");
  CHECK(value_sent(alone, 5, 1e30F) == "2 2 0");
  World world(curve + "DEF T Transform { } ROUTE I.value_changed TO T.translation");
  world.start();
  world.send("I.keyWeight", MFFloat{1, 0.5F, 1});  // the middle point is (2 0 0) / 0.5
  world.send_at(1, "I.set_fraction", SFFloat{0.5F});
  CHECK(world.scene().get<SFVec3f>(world.node("T"), "translation").x == Approx(2));
  world.send("I.set_dimension", SFInt32{2});  // fewer points than the order: no curve
  (void)world.take();
  world.send_at(2, "I.set_fraction", SFFloat{0.25F});
  CHECK(world.take().empty());
}

TEST_CASE("sends orientations along the tangent of a NurbsOrientationInterpolator") {
  World world("DEF I NurbsOrientationInterpolator { order 2 controlPoint Coordinate { point [ 0 0 0, 3 0 0 ] } }");
  world.start();
  world.send_at(1, "I.set_fraction", SFFloat{0.5F});
  const Lines lines = world.take();
  REQUIRE(lines.size() == 1);
  CHECK(lines.front().find("value_changed 0 1 0 1.570796") != std::string::npos);
}

TEST_CASE("sends positions and normals of a NurbsSurfaceInterpolator") {
  World world(
      "DEF I NurbsSurfaceInterpolator { uDimension 2 vDimension 2 uOrder 2 vOrder 2 "
      "controlPoint Coordinate { point [ 0 0 0, 2 0 0, 0 2 0, 2 2 0 ] } }");
  world.start();
  world.send_at(1, "I.set_fraction", SFVec2f{0.25F, 0.5F});
  const Lines lines = world.take();
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].find("position_changed 0.5 1 0") != std::string::npos);
  CHECK(lines[1].find("normal_changed 0 0 1") != std::string::npos);
}

}  // namespace gs::vrml::traces
