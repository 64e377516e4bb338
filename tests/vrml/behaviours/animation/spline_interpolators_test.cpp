#include "tests/vrml/events/trace.h"

#include <cmath>
#include <string>

// Tests of the X3D interpolators (X3D clause 19).
namespace gs::vrml::traces {
namespace {

// Sends a fraction to I, and returns the text of the value that it sends.
std::string value_at(World& world, float fraction) {
  world.execution().cascade().begin_update();
  world.send("I.set_fraction", SFFloat{fraction});
  const Lines lines = world.take();
  if (lines.size() != 1) return "events: " + std::to_string(lines.size());
  return lines[0].substr(lines[0].find(' ', lines[0].find('.', lines[0].find('I'))) + 1);
}

double number_at(World& world, float fraction) { return std::stod(value_at(world, fraction)); }

}  // namespace

TEST_CASE("interpolates between 2D points and lists of 2D points (X3D 19.4.3, 19.4.8)") {
  X3DWorld point("DEF I PositionInterpolator2D { key [ 0 1 ] keyValue [ 0 0, 2 4 ] }");
  point.start();
  CHECK(value_at(point, 0.25F) == "0.5 1");
  X3DWorld list("DEF I CoordinateInterpolator2D { key [ 0 1 ] keyValue [ 0 0, 1 1, 2 4, 3 5 ] }");
  list.start();
  CHECK(value_at(list, 0.5F) == "[ 1 2, 2 3 ]");
  CHECK(value_at(list, 2) == "[ 2 4, 3 5 ]");
}

TEST_CASE("interpolates smoothly through the keys of a spline (X3D 19.4.12)") {
  X3DWorld world("DEF I SplineScalarInterpolator { key [ 0 0.25 0.5 0.75 1 ] keyValue [ 0 1 2 3 4 ] }");
  world.start();
  CHECK(value_at(world, 0) == "0");
  CHECK(value_at(world, 0.5F) == "2");
  CHECK(value_at(world, 1) == "4");
  CHECK(number_at(world, 0.375F) == Approx(1.5));
  // The velocity at the ends is 0, so the curve starts slowly: S(0.5) = 0.5 * 0 + 0.5 * 1 - 0.125 * 1.
  CHECK(number_at(world, 0.125F) == Approx(0.375));
}

TEST_CASE("uses given velocities of a spline, for all keys or for both ends (X3D 19.2.4)") {
  X3DWorld all("DEF I SplineScalarInterpolator { key [ 0 1 ] keyValue [ 0 1 ] keyVelocity [ 1 1 ] }");
  all.start();
  CHECK(number_at(all, 0.25F) == Approx(0.25));
  X3DWorld ends("DEF I SplineScalarInterpolator { key [ 0 0.5 1 ] keyValue [ 0 1 2 ] keyVelocity [ 1 1 ] }");
  ends.start();
  CHECK(number_at(ends, 0.25F) == Approx(0.5));
  X3DWorld normal(
      "DEF I SplineScalarInterpolator { key [ 0 1 ] keyValue [ 0 4 ] keyVelocity [ 1 1 ] normalizeVelocity TRUE }");
  normal.start();
  CHECK(number_at(normal, 0.25F) == Approx(1));
}

TEST_CASE("closes a spline with equal ends (X3D 19.4.10)") {
  const std::string curve = "key [ 0 0.25 0.5 0.75 1 ] keyValue [ 0 0 0, 1 0 0, 1 1 0, 0 1 0, 0 0 0 ]";
  X3DWorld open("DEF I SplinePositionInterpolator { " + curve + " }");
  X3DWorld closed("DEF I SplinePositionInterpolator { " + curve + " closed TRUE }");
  open.start();
  closed.start();
  CHECK(value_at(open, 0.125F) == "0.4375 -0.0625 0");
  CHECK(value_at(closed, 0.125F) == "0.5 -0.125 0");
}

TEST_CASE("adjusts velocities of a spline for keys at unequal distances (X3D 19.2.4)") {
  X3DWorld world("DEF I SplinePositionInterpolator2D { key [ 0 0.25 1 ] keyValue [ 0 0, 1 1, 2 2 ] }");
  world.start();
  // T = 1 at the middle key; F- = 2 * 0.75 = 1.5, F+ = 2 * 0.25 = 0.5.
  CHECK(value_at(world, 0.125F) == "0.3125 0.3125");
  CHECK(value_at(world, 0.625F) == "1.5625 1.5625");
}

TEST_CASE("turns smoothly through the keys of a SquadOrientationInterpolator (X3D 19.4.13)") {
  X3DWorld world("DEF I SquadOrientationInterpolator { key [ 0 0.5 1 ] keyValue [ 0 1 0 0, 0 1 0 1, 0 1 0 2 ] }");
  world.start();
  CHECK(value_at(world, 0.5F) == "0 1 0 1");
  CHECK(value_at(world, 0.25F) == "0 1 0 0.5");
  CHECK(value_at(world, 2) == "0 1 0 2");
}

TEST_CASE("eases in and out of intervals in an EaseInEaseOut (X3D 19.4.4)") {
  X3DWorld world("DEF I EaseInEaseOut { key [ 0 1 ] easeInEaseOut [ 0 0.5, 0.5 0 ] }");
  world.start();
  CHECK(number_at(world, 0) == Approx(0));
  CHECK(number_at(world, 0.25F) == Approx(0.125));
  CHECK(number_at(world, 0.5F) == Approx(0.5));
  CHECK(number_at(world, 0.75F) == Approx(0.875));
  CHECK(number_at(world, 1) == Approx(1));
  X3DWorld even("DEF I EaseInEaseOut { key [ 0 1 ] easeInEaseOut [ 0 0, 0 0 ] }");
  even.start();
  CHECK(number_at(even, 0.3F) == Approx(0.3));
}

}  // namespace gs::vrml::traces
