#include "app/simulation/input_rows.h"
#include "app/simulation/simulation.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>
#include <glm/vec3.hpp>

#include <string>
#include <vector>

// Tests of walking in whole worlds: collidable Shapes (VRML97 6.8), Viewpoints and NavigationInfo.
namespace gs::app::walked_worlds_test {
namespace {

/// Viewer's position after holding W for some seconds, with the names of the reported Collision nodes.
struct Walked {
  glm::dvec3 place;
  std::vector<std::string> collisions;
};

Walked walked(const std::string& body, double seconds = 4) {
  Simulation simulation(world_of(body), {64, 64});
  Walked result;
  simulation.execution().cascade().observe([&](const vrml::SentEvent& event) {
    if (event.event->name == "collideTime") result.collisions.emplace_back(event.scene->node(event.node).name);
  });
  Diagnostics diagnostics;
  const auto rows = read_input_rows("{\"t\":0.1,\"key\":\"w\",\"down\":true}\n", "in.jsonl", diagnostics);
  REQUIRE(simulation.plan(rows, "in.jsonl", diagnostics));
  simulation.run(seconds);
  result.place = glm::dvec3(simulation.camera().world_from_camera[3]);
  return result;
}

const std::string kViewer = "NavigationInfo { type \"WALK\" speed 2 } Viewpoint { position 0 1.6 0 }\n";
const std::string kFloor =
    "Shape { geometry IndexedFaceSet { coord Coordinate { point [ -50 0 -50, -50 0 50, 50 0 50, 50 0 -50 ] } "
    "coordIndex [ "
    "0 1 2 3 ] } }\n";
const std::string kWall = "Transform { translation 0 2 -3.5 children Shape { geometry Box { size 10 4 1 } } }\n";

}  // namespace

TEST_CASE("stops a walking viewer avatarSize[0] before a Shape (4.13.4)") {
  CHECK(walked(kViewer + kFloor).place.z < -7);
  CHECK(walked(kViewer + kFloor + kWall).place.z == Approx(-2.75).margin(0.02));
  CHECK(walked("NavigationInfo { type \"WALK\" speed 2 avatarSize [ 1, 1.6, 0.5 ] } Viewpoint { position 0 1.6 0 }\n" +
               kFloor + kWall)
            .place.z == Approx(-2).margin(0.02));
  CHECK(walked("NavigationInfo { type \"FLY\" speed 2 } Viewpoint { position 0 1.6 0 }\n" + kWall).place.z ==
        Approx(-2.75).margin(0.02));
  CHECK(walked("NavigationInfo { type \"EXAMINE\" } Viewpoint { position 0 1.6 0 }\n" + kWall).collisions.empty());
}

TEST_CASE("drops a walking viewer to avatarSize[1] above the ground, and lifts the viewer with it (6.29)") {
  CHECK(walked("NavigationInfo { type \"WALK\" avatarSize [ 0.2, 1, 0.5 ] } Viewpoint { position 0 3 0 }\n" + kFloor, 2)
            .place.y == Approx(1).margin(0.01));
  const Walked stairs = walked(
      kViewer + kFloor + "Transform { translation 0 0.25 -4 children Shape { geometry Box { size 20 0.5 4 } } }\n");
  CHECK(stairs.place.z < -7);
  CHECK(stairs.place.y == Approx(1.6).margin(0.01));  // up and down again
}

TEST_CASE("passes a Collision with collide FALSE, and reports collisions with others (6.8)") {
  const Walked through = walked(kViewer + kFloor + "DEF C Collision { collide FALSE children " + kWall + "}");
  CHECK(through.place.z < -7);
  CHECK(through.collisions.empty());
  const Walked stopped = walked(kViewer + kFloor + "DEF C Collision { children " + kWall + "}");
  CHECK(stopped.place.z == Approx(-2.75).margin(0.02));
  REQUIRE_FALSE(stopped.collisions.empty());
  CHECK(stopped.collisions.front() == "C");
}

TEST_CASE("collides with a proxy instead of the children, with and without children (6.8)") {
  const std::string thin = "Transform { translation 0 2 -5 children Shape { geometry Box { size 10 4 0.1 } } }";
  CHECK(walked(kViewer + kFloor + "DEF C Collision { proxy " + thin + " children " + kWall + "}").place.z ==
        Approx(-4.7).margin(0.02));
  const Walked alone = walked(kViewer + kFloor + "DEF C Collision { proxy " + thin + "}");
  CHECK(alone.place.z == Approx(-4.7).margin(0.02));
  REQUIRE_FALSE(alone.collisions.empty());
  CHECK(alone.collisions.front() == "C");
  CHECK(walked(kViewer + kFloor + "Collision { collide FALSE proxy " + thin + " children " + kWall + "}").place.z < -7);
  // Content of a Collision with collide FALSE is not collidable.
  CHECK(walked(kViewer + kFloor + "Collision { collide FALSE children Collision { children " + kWall + "} }").place.z <
        -7);
}

TEST_CASE("passes through lines, points and Text (6.8, 6.47)") {
  const std::string thin =
      "Shape { geometry IndexedLineSet { coord Coordinate { point [ -9 1 -3, 9 1 -3 ] } coordIndex [ 0 1 ] } }\n"
      "Shape { geometry PointSet { coord Coordinate { point [ 0 1.6 -3 ] } } }\n"
      "Transform { translation -4 0 -3 children Shape { geometry Text { string \"WWWWWWWW\" fontStyle FontStyle { size "
      "3 } } } }\n";
  CHECK(walked(kViewer + kFloor + thin).place.z < -7);
}

TEST_CASE("uses avatarSize, speed and down in the bound Viewpoint's coordinates (6.29)") {
  // The avatar is twice as large: 0.5 from the wall, the eye 3.2 above the floor, 4 units per second.
  const Walked large = walked(
      "NavigationInfo { type \"WALK\" speed 2 } Transform { scale 2 2 2 children Viewpoint { position 0 3 0 } "
      "}\n" +
          kFloor + kWall,
      1.1);
  CHECK(large.place.y < 6);
  const Walked there = walked(
      "NavigationInfo { type \"WALK\" speed 2 } Transform { scale 2 2 2 children Viewpoint { position 0 2 0 } "
      "}\n" +
      kFloor + kWall);
  CHECK(there.place.z == Approx(-2.5).margin(0.03));
  CHECK(there.place.y == Approx(3.2).margin(0.02));
  // A quarter turn about Z: down is +X.
  const Walked turned = walked(
      "NavigationInfo { type \"WALK\" speed 2 } Transform { rotation 0 0 1 1.5707963 children [ Viewpoint { "
      "position 0 4 0 } " +
          kFloor + "] }",
      3);
  CHECK(turned.place.x == Approx(-1.6).margin(0.02));
  CHECK(turned.place.z < -4);
}

TEST_CASE("begins worlds at their Viewpoint, without gravity before the first movement") {
  Simulation simulation(world_of("NavigationInfo { type \"WALK\" } Viewpoint { position 0 30 0 }\n" + kFloor),
                        {64, 64});
  simulation.run(3);
  CHECK(simulation.camera().world_from_camera[3].y == 30);
}

}  // namespace gs::app::walked_worlds_test
