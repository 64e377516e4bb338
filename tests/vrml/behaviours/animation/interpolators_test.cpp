#include "tests/vrml/events/trace.h"
#include "vrml/behaviours/animation/interpolation.h"

#include <glm/glm.hpp>

#include <cmath>
#include <limits>
#include <string>

namespace gs::vrml::traces {

namespace {

// Returns the value that an interpolator sends for a fraction, or "" if it sends none.
std::string sent(World& world, double at, float fraction) {
  world.send_at(at, "I.set_fraction", SFFloat{fraction});
  const Lines lines = world.take();
  if (lines.empty()) return {};
  return lines.front().substr(lines.front().find("value_changed") + 14);
}

constexpr float kPi = 3.14159265F;

}  // namespace

TEST_CASE("returns the first or last value for fractions outside the keys (4.6.8)") {
  World world("DEF I ScalarInterpolator { key [ 0.25 0.5 1 ] keyValue [ 1 2 4 ] }");
  world.start();
  CHECK(sent(world, 1, 0) == "1");
  CHECK(sent(world, 2, 0.25F) == "1");
  CHECK(sent(world, 3, 0.375F) == "1.5");
  CHECK(sent(world, 4, 0.5F) == "2");
  CHECK(sent(world, 5, 0.75F) == "3");
  CHECK(sent(world, 6, 1) == "4");
  CHECK(sent(world, 7, 5) == "4");
  CHECK(sent(world, 8, -5) == "1");
}

TEST_CASE("jumps to the next value at equal keys (4.6.8)") {
  World world("DEF I ScalarInterpolator { key [ 0 0.5 0.5 0.5 1 ] keyValue [ 0 1 7 2 3 ] }");
  world.start();
  CHECK(sent(world, 1, 0.25F) == "0.5");
  CHECK(sent(world, 2, 0.5F) == "2");
  CHECK(sent(world, 3, 0.75F) == "2.5");
}

TEST_CASE("accepts one key, no key, wrong counts, decreasing keys and NaN fractions") {
  World world("DEF I ScalarInterpolator { }");
  world.start();
  CHECK(sent(world, 1, 0.5F).empty());
  world.send("I.key", MFFloat{0.5F});
  (void)world.take();
  CHECK(sent(world, 2, 0.5F).empty());
  world.send("I.keyValue", MFFloat{3, 4, 5});
  (void)world.take();
  CHECK(sent(world, 3, 0.9F) == "3");
  world.send("I.key", MFFloat{0, 1, 0.2F, 0.1F, 7});
  (void)world.take();
  CHECK(!sent(world, 4, 0.5F).empty());
  CHECK(!sent(world, 5, std::numeric_limits<float>::quiet_NaN()).empty());
  CHECK(!sent(world, 6, std::numeric_limits<float>::infinity()).empty());
}

TEST_CASE("interpolates positions linearly (6.37)") {
  World world(
      "DEF I PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 2 4 -8 ] } DEF T Transform { } "
      "ROUTE I.value_changed TO T.translation");
  world.start();
  CHECK(sent(world, 1, 0.25F) == "0.5 1 -2");
  CHECK(world.scene().get<SFVec3f>(world.node("T"), "translation") == SFVec3f(0.5F, 1, -2));
}

TEST_CASE("interpolates colours in HSV, with the hue on the shorter way (6.10)") {
  World world("DEF I ColorInterpolator { key [ 0 1 2 ] keyValue [ 1 0 0, 0 1 0, 0 0 1 ] }");
  world.start();
  CHECK(sent(world, 1, 0.5F) == "1 1 0");
  CHECK(sent(world, 2, 1.5F) == "0 1 1");
  CHECK(between_colors({1, 0, 0}, {0, 0, 1}, 0.5F) == Color{1, 0, 1});
  CHECK(between_colors({0, 0, 1}, {1, 0, 0}, 0.5F) == Color{1, 0, 1});
  // Grey has no hue, so red only grows paler on the way to white.
  CHECK(between_colors({1, 0, 0}, {1, 1, 1}, 0.5F) == Color{1, 0.5F, 0.5F});
  CHECK(between_colors({0, 0, 0}, {0, 0, 1}, 0.5F) == Color{0.25F, 0.25F, 0.5F});
  CHECK(between_colors({0, 0, 0}, {1, 1, 1}, 0.5F) == Color{0.5F, 0.5F, 0.5F});
}

TEST_CASE("interpolates orientations along the shortest rotation (6.32)") {
  const auto angle_about_y = [](const SFRotation& r) { return r.y * r.angle; };
  const SFRotation half = between_rotations({0, 1, 0, 0}, {0, 1, 0, kPi / 2}, 0.5F);
  CHECK(angle_about_y(half) == Approx(kPi / 4));
  // The rotations are -20 and +20 degrees; the second is written as 380. The interpolator turns by 40 degrees, not by
  // 400 or 320.
  const SFRotation through = between_rotations({0, -1, 0, 0.349066F}, {0, 1, 0, 6.632251F}, 0.75F);
  CHECK(angle_about_y(through) == Approx(0.174533).margin(1e-5));
  // 1.5 pi is a quarter turn in the other direction.
  CHECK(angle_about_y(between_rotations({0, 1, 0, 0}, {0, 1, 0, 1.5F * kPi}, 0.5F)) == Approx(-kPi / 4));
  // The axis may have any length. An axis of length 0 turns nothing.
  CHECK(angle_about_y(between_rotations({0, 0, 0, 2}, {0, 5, 0, kPi / 2}, 0.5F)) == Approx(kPi / 4));
  const SFRotation nothing = between_rotations({0, 0, 0, 0}, {0, 0, 0, 0}, 0.5F);
  CHECK(nothing == SFRotation{0, 0, 1, 0});
  World world("DEF I OrientationInterpolator { key [ 0 1 ] keyValue [ 1 0 0 0.5, 0 1 0 7 ] }");
  world.start();
  CHECK(sent(world, 1, 1) == "0 1 0 7");  // the value of the file at a key
}

TEST_CASE("interpolates every point of a key in a CoordinateInterpolator, and ignores an incomplete last key (6.13)") {
  World world(
      "DEF I CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1, 2 0 0, 3 1 1, 9 9 9 ] } "
      "DEF C Coordinate { } ROUTE I.value_changed TO C.point");
  world.start();
  CHECK(sent(world, 1, 0.5F) == "[ 1 0 0, 2 1 1 ]");
  CHECK(sent(world, 2, 1) == "[ 2 0 0, 3 1 1 ]");
  CHECK(world.scene().get<MFVec3f>(world.node("C"), "point") == MFVec3f{{2, 0, 0}, {3, 1, 1}});
  world.send("I.keyValue", MFVec3f{{1, 2, 3}});
  (void)world.take();
  CHECK(sent(world, 3, 0.5F).empty());
}

TEST_CASE("alternates two arrays, so that a running CoordinateInterpolator allocates nothing") {
  World world(
      "DEF I CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 1 1, 2 0 0, 3 1 1 ] } "
      "DEF C Coordinate { } ROUTE I.value_changed TO C.point");
  world.start();
  const SFVec3f* places[6];
  for (int i = 0; i < 6; ++i) {
    (void)sent(world, i + 1, 0.1F * static_cast<float>(i));
    places[i] = world.scene().get<MFVec3f>(world.node("C"), "point").data();
  }
  CHECK(places[2] != places[3]);
  CHECK(places[2] == places[4]);
  CHECK(places[3] == places[5]);
}

TEST_CASE("keeps interpolated normals on the unit sphere (6.31)") {
  const SFVec3f half = between_normals({1, 0, 0}, {0, 1, 0}, 0.5F);
  CHECK(half.x == Approx(std::sqrt(0.5)));
  CHECK(half.y == Approx(std::sqrt(0.5)));
  const SFVec3f third = between_normals({1, 0, 0}, {0, 1, 0}, 1.0F / 3);
  CHECK(std::atan2(third.y, third.x) == Approx(kPi / 6));
  CHECK(glm::length(between_normals({1, 0, 0}, {-1, 0, 0}, 0.5F)) == Approx(1));
  CHECK(between_normals({0, 0, 0}, {0, 2, 0}, 0.5F) == SFVec3f(0, 1, 0));
}

}  // namespace gs::vrml::traces
