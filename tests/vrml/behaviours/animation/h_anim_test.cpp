#include "tests/vrml/events/trace.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>

// Tests of humanoids (X3D component HAnim).
namespace gs::vrml::traces {
namespace {

// Returns the point with this index of the Coordinate C, or of another node.
SFVec3f point_of(World& world, std::size_t index, const char* node = "C", const char* field = "point") {
  const MFVec3f& points = world.scene().get<MFVec3f>(world.node(node), field);
  return index < points.size() ? points[index] : SFVec3f(-99);
}

void check_near(const SFVec3f& a, const SFVec3f& b) {
  CAPTURE(a.x, a.y, a.z, b.x, b.y, b.z);
  CHECK(glm::length(a - b) < 1e-5F);
}

constexpr const char* kArm =
    "DEF H HAnimHumanoid { skinCoord DEF C Coordinate { point [ 0 0 0, 0 1 0, 0 2 0, 0 3 0, 9 9 9 ] } "
    "skinNormal DEF N Normal { vector [ 1 0 0, 1 0 0, 1 0 0, 1 0 0, 1 0 0 ] } "
    "skin Shape { geometry PointSet { coord USE C } } "
    "skeleton DEF Upper HAnimJoint { name \"upper\" skinCoordIndex [ 0 1 2 ] skinCoordWeight [ 1 1 0.5 ] "
    " children [ HAnimSegment { children Shape { } } "
    " DEF Lower HAnimJoint { name \"lower\" center 0 2 0 skinCoordIndex [ 3 2 7 -1 ] skinCoordWeight [ 1 0.5 1 1 ] "
    "  displacers DEF D HAnimDisplacer { coordIndex [ 3 ] displacements [ 1 0 0 ] } } ] } ";

}  // namespace

TEST_CASE("moves the skin with the joints, by their weights") {
  World world(std::string(kArm) + "joints [ USE Upper USE Lower ] }");
  world.start();
  check_near(point_of(world, 3), {0, 3, 0});
  world.send_at(1, "Lower.set_rotation", SFRotation{0, 0, 1, 1.5707963F});
  world.step(1.5);
  check_near(point_of(world, 0), {0, 0, 0});
  check_near(point_of(world, 2), {0, 2, 0});  // the centre of the lower joint
  check_near(point_of(world, 3), {-1, 2, 0});
  check_near(point_of(world, 4), {9, 9, 9});  // no joint moves it
  check_near(point_of(world, 3, "N", "vector"), {0, 1, 0});
  check_near(point_of(world, 0, "N", "vector"), {1, 0, 0});
  world.send_at(2, "Upper.set_translation", SFVec3f{0, 0, 5});
  world.step(2.5);
  check_near(point_of(world, 0), {0, 0, 5});
  check_near(point_of(world, 3), {-1, 2, 5});
}

TEST_CASE("moves skin points by displacers, in the directions of their joint") {
  World world(std::string(kArm) + "}");
  world.start();
  world.send_at(1, "D.set_weight", SFFloat{2});
  world.step(1.5);
  check_near(point_of(world, 3), {2, 3, 0});
  world.send_at(2, "Lower.set_rotation", SFRotation{0, 0, 1, 1.5707963F});
  world.step(2.5);
  check_near(point_of(world, 3), {-1, 4, 0});
}

TEST_CASE("binds the skin to the pose of jointBindingPositions") {
  World world(
      "HAnimHumanoid { skinCoord DEF C Coordinate { point 4 1 0 } "
      "skeleton DEF J HAnimJoint { skinCoordIndex 0 skinCoordWeight 1 } "
      "joints USE J jointBindingPositions 4 0 0 jointBindingRotations 0 0 1 0 }");
  world.start();
  world.step(0.5);
  // The joint stands at the origin, 4 metres from its place in the binding pose.
  check_near(point_of(world, 0), {0, 1, 0});
}

TEST_CASE("adds the displacements of a segment to its coordinates") {
  World world(
      "HAnimSegment { coord DEF C Coordinate { point [ 1 1 1, 2 2 2 ] } displacers DEF D HAnimDisplacer { coordIndex "
      "[ 1, 5, -2 ] displacements [ 0 1 0, 0 0 0, 0 0 0 ] } children Shape { geometry PointSet { coord USE C } } }");
  world.start();
  world.send_at(1, "D.set_weight", SFFloat{0.5F});
  world.step(1.5);
  check_near(point_of(world, 0), {1, 1, 1});
  check_near(point_of(world, 1), {2, 2.5F, 2});
  world.send_at(2, "D.set_weight", SFFloat{0});
  world.step(2.5);
  check_near(point_of(world, 1), {2, 2, 2});
}

TEST_CASE("plays an HAnimMotion once, or in a loop") {
  const auto text = [](const std::string& loop) {
    return std::string(kArm) + "motions DEF M HAnimMotion { frameDuration 1 loop " + loop +
           " joints \"Up_per lower\" channels \"3 Xposition Yposition Zposition 1 Zrotation\" "
           "values [ 0 0 0 0, 1 0 0 90, 2 0 0 0 ] } }";
  };
  World once(text("FALSE"));
  once.start(0);
  once.step(1.5);
  CHECK(once.scene().get<SFVec3f>(once.node("Upper"), "translation") == SFVec3f(1, 0, 0));
  CHECK(once.scene().get<SFRotation>(once.node("Lower"), "rotation").angle == Approx(1.5707963));
  check_near(point_of(once, 3), {0, 2, 0});
  once.step(10);
  CHECK(once.scene().get<SFVec3f>(once.node("Upper"), "translation") == SFVec3f(2, 0, 0));
  CHECK(!once.scene().get<SFBool>(once.node("M"), "enabled"));
  World loops(text("TRUE"));
  loops.start(0);
  loops.step(10.5);
  CHECK(loops.scene().get<SFVec3f>(loops.node("Upper"), "translation") == SFVec3f(1, 0, 0));
  CHECK(loops.scene().get<SFInt32>(loops.node("M"), "frameIndex") == 1);
}

TEST_CASE("plays only the motions that motionsEnabled allows") {
  World world(
      std::string(kArm) +
      "motionsEnabled FALSE motions DEF M HAnimMotion { frameDuration 1 joints \"upper\" channels \"3 Xposition "
      "Yposition Zposition\" values [ 1 0 0, 1 0 0, 2 0 0 ] } }");
  world.start(0);
  world.step(1.5);
  CHECK(world.scene().get<SFVec3f>(world.node("Upper"), "translation") == SFVec3f(0, 0, 0));
  world.send_at(2, "H.set_motionsEnabled", MFBool{true});
  world.step(3.5);
  CHECK(world.scene().get<SFVec3f>(world.node("Upper"), "translation") == SFVec3f(1, 0, 0));
}

TEST_CASE("accepts humanoids without skin, with broken motions and with joints in a cycle") {
  for (const char* text :
       {"HAnimHumanoid { }", "HAnimHumanoid { skeleton HAnimJoint { } motions HAnimMotion { } }",
        "HAnimHumanoid { motions HAnimMotion { joints \"a b\" channels \"6 Xposition 3\" values [ 1 ] } }",
        "HAnimHumanoid { skeleton DEF J HAnimJoint { children USE J skinCoordIndex [ -1 2000000000 ] } skinCoord "
        "Coordinate { point 0 0 0 } }",
        "DEF M HAnimMotion { channels \"1 Xposition\" values [ 1 2 3 ] }"}) {
    CAPTURE(text);
    World world(text);
    world.start();
    world.step(3);
    CHECK(world.execution().now() == World::kStart + 3);
  }
}

}  // namespace gs::vrml::traces
