#include "tests/vrml/events/trace.h"

#include <string>

// Tests of picking sensors and TransformSensor (X3D clause 38, 22.4.2).
namespace gs::vrml::traces {
namespace {

// World with a box at the origin and a picking sensor that a Transform moves.
std::string sensor_world(const std::string& sensor, const std::string& target =
                                                        "DEF Target Transform { children "
                                                        "Shape { geometry DEF B Box { } } }") {
  return target + " DEF Move Transform { translation 5 0 0 children DEF S " + sensor + " }";
}

Lines pick_at(World& world, double at, const SFVec3f& position) {
  world.send_at(at, "Move.translation", position);
  return world.take_at(at + 0.5, "S.");
}

}  // namespace

TEST_CASE("reports the picked geometry of a LinePickSensor, its points, normals and coordinates (X3D 38.4.1)") {
  X3DWorld world(sensor_world(
      "LinePickSensor { intersectionType \"GEOMETRY\" sortOrder \"ALL\" pickTarget USE Target pickingGeometry "
      "IndexedLineSet { coord Coordinate { point [ 0 0.5 0, 3 0.5 0 ] } coordIndex [ 0 1 -1 ] } }"));
  world.start();
  world.step(1);
  CHECK(world.take().empty());
  CHECK_FALSE(world.execution().next_time());
  CHECK(pick_at(world, 2, {-2.5F, 0, 0}) == Lines{"2.5 S.isActive TRUE", "2.5 S.pickedGeometry [ B ]",
                                                  "2.5 S.pickedPoint [ -1 0.5 0 ]", "2.5 S.pickedNormal [ -1 0 0 ]",
                                                  "2.5 S.pickedTextureCoordinate [ 0.5 0.75 0 ]"});
  CHECK(pick_at(world, 3, {9, 0, 0}) == Lines{"3.5 S.isActive FALSE", "3.5 S.pickedGeometry [ ]",
                                              "3.5 S.pickedPoint [ ]", "3.5 S.pickedNormal [ ]",
                                              "3.5 S.pickedTextureCoordinate [ ]"});
  CHECK_FALSE(world.execution().next_time());
}

TEST_CASE("compares bounding boxes for BOUNDS, and geometries for GEOMETRY (X3D 38.3.1)") {
  const std::string sphere = "pickTarget USE Target pickingGeometry Sphere { } }";
  X3DWorld bounds(sensor_world("PrimitivePickSensor { " + sphere));
  X3DWorld exact(sensor_world("PrimitivePickSensor { intersectionType \"GEOMETRY\" " + sphere));
  bounds.start();
  exact.start();
  // The boxes overlap at their corners, but the sphere does not reach the box.
  CHECK(pick_at(bounds, 1, {1.9F, 1.9F, 0}) == Lines{"1.5 S.isActive TRUE", "1.5 S.pickedGeometry [ B ]"});
  CHECK(pick_at(exact, 1, {1.9F, 1.9F, 0}).empty());
  CHECK(pick_at(exact, 2, {1.5F, 1.5F, 0}) == Lines{"2.5 S.isActive TRUE", "2.5 S.pickedGeometry [ B ]"});
}

TEST_CASE("picks a volume inside of another one (X3D 38.4.5)") {
  X3DWorld world(
      sensor_world("VolumePickSensor { intersectionType \"GEOMETRY\" pickTarget USE Target pickingGeometry Sphere { "
                   "radius 0.1 } }"));
  world.start();
  CHECK(pick_at(world, 1, {0.3F, 0, 0}).size() == 2);
}

TEST_CASE("reports the points of a PointPickSensor that are inside of a geometry (X3D 38.4.3)") {
  X3DWorld world(sensor_world(
      "PointPickSensor { intersectionType \"GEOMETRY\" pickTarget USE Target pickingGeometry PointSet { coord "
      "Coordinate { point [ 0 0 0, 0.25 0 0, 4 0 0 ] } } }"));
  world.start();
  CHECK(pick_at(world, 1, {0.5F, 0, 0}) ==
        Lines{"1.5 S.isActive TRUE", "1.5 S.pickedGeometry [ B ]", "1.5 S.pickedPoint [ 0 0 0, 0.25 0 0 ]"});
}

TEST_CASE("sorts the picked geometries by sortOrder (X3D 38.3.1)") {
  const std::string target =
      "DEF Target Group { children [ Transform { translation 0.6 0 0 children Shape { geometry DEF Far Box { } } } "
      "Transform { translation 0.2 0 0 children Shape { geometry DEF Near Box { } } } ] }";
  const auto picked = [&](const std::string& order) {
    X3DWorld world(sensor_world(
        "PrimitivePickSensor { sortOrder \"" + order + "\" pickTarget USE Target pickingGeometry Sphere { } }",
        target));
    world.start();
    return pick_at(world, 1, {0, 0, 0}).back();
  };
  CHECK(picked("ANY") == "1.5 S.pickedGeometry [ Far ]");
  CHECK(picked("CLOSEST") == "1.5 S.pickedGeometry [ Near ]");
  CHECK(picked("ALL") == "1.5 S.pickedGeometry [ Far, Near ]");
  CHECK(picked("ALL_SORTED") == "1.5 S.pickedGeometry [ Near, Far ]");
}

TEST_CASE("matches the object types of a sensor and of a PickableGroup (X3D 38.3.2, 38.4.2)") {
  const auto picks = [&](const std::string& group, const std::string& sensor) {
    X3DWorld world(
        sensor_world("PrimitivePickSensor { " + sensor + " pickTarget USE Target pickingGeometry Sphere { } }",
                     "DEF Target PickableGroup { " + group + " children Shape { geometry DEF B Box { } } }"));
    world.start();
    return !pick_at(world, 1, {0, 0, 0}).empty();
  };
  CHECK(picks("", ""));
  CHECK_FALSE(picks("pickable FALSE", ""));
  CHECK(picks("objectType [ \"A\" \"B\" ]", ""));
  CHECK_FALSE(picks("objectType \"NONE\"", ""));
  CHECK(picks("objectType [ \"A\" \"B\" ]", "objectType [ \"B\" \"C\" ]"));
  CHECK_FALSE(picks("objectType [ \"A\" \"B\" ]", "objectType [ \"B\" \"C\" ] matchCriterion \"MATCH_EVERY\""));
  CHECK(picks("objectType [ \"A\" \"B\" ]", "objectType [ \"B\" \"C\" ] matchCriterion \"MATCH_ONLY_ONE\""));
  CHECK_FALSE(picks("objectType [ \"A\" \"B\" ]", "objectType [ \"A\" \"B\" ] matchCriterion \"MATCH_ONLY_ONE\""));
}

TEST_CASE("picks with each instance of a sensor (X3D 38.3.1)") {
  X3DWorld world(sensor_world("PrimitivePickSensor { pickTarget USE Target pickingGeometry Sphere { } }") +
                 " Transform { translation 0 9 0 children USE S }");
  world.start();
  CHECK(pick_at(world, 1, {7, 0, 0}).empty());
  world.send_at(2, "Target.translation", SFVec3f(0, 8, 0));
  CHECK(world.take_at(2.5, "S.") == Lines{"2.5 S.isActive TRUE", "2.5 S.pickedGeometry [ B ]"});
}

TEST_CASE("picks nothing with a disabled sensor (X3D 38.3.1)") {
  X3DWorld world(
      sensor_world("PrimitivePickSensor { enabled FALSE pickTarget USE Target pickingGeometry Sphere { } }"));
  world.start();
  CHECK(pick_at(world, 1, {0, 0, 0}).empty());
  world.send_at(2, "S.enabled", SFBool{true});
  CHECK(world.take("S.isActive") == Lines{"2 S.isActive TRUE"});
}

TEST_CASE("reports a target that enters, moves in and leaves the box of a TransformSensor (X3D 22.4.2)") {
  X3DWorld world(
      "DEF S TransformSensor { size 4 4 4 targetObject DEF T Transform { translation 9 0 0 children Shape { geometry "
      "Box { } } } } Group { children USE T }");
  world.start();
  world.step(1);
  CHECK(world.take().empty());
  const auto moved = [&](double at, float x) {
    world.send_at(at, "T.translation", SFVec3f(x, 0, 0));
    return world.take_at(at + 0.5, "S.");
  };
  CHECK(moved(2, 2.5F) == Lines{"2.5 S.isActive TRUE", "2.5 S.enterTime 1002.5", "2.5 S.position_changed 2.5 0 0",
                                "2.5 S.orientation_changed 0 0 1 0"});
  CHECK(moved(3, 1) == Lines{"3.5 S.position_changed 1 0 0"});
  CHECK(moved(4, 8) == Lines{"4.5 S.isActive FALSE", "4.5 S.exitTime 1004.5"});
  CHECK_FALSE(world.execution().next_time());
}

}  // namespace gs::vrml::traces
