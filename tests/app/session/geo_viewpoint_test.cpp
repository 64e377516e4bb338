// Tests of navigation above an ellipsoid, from a GeoViewpoint (X3D 25.3.11).
#include "tests/app/one_world.h"
#include "vrml/scene/coordinates/geospatial.h"
#include "vrml/syntax/parser.h"

#include <glm/geometric.hpp>

#include <memory>
#include <string>

namespace gs::app::geo_viewpoint_test {
namespace {

using namespace sessions;

constexpr double kRadius = 6378137;

/// Session of an X3D world, with the viewer at a GeoViewpoint that looks to the north.
struct GeoWorld {
  explicit GeoWorld(const std::string& viewpoint) {
    LoadedWorld world;
    world.scene = std::make_unique<vrml::SceneGraph>("world.x3dv");
    (void)vrml::parse(
        "#X3D V3.3 utf8\nPROFILE Full\nNavigationInfo { type \"FLY\" } GeoViewpoint { " + viewpoint + " }",
        *world.scene, world.diagnostics);
    CHECK(world.diagnostics.errors() == 0);
    document = hold_world(std::move(world));
    begin_world(*document, kStart);
    session.readers().show(document);
    frame = session.step(kStart, input_of({}));
  }
  /// Returns the metres that the viewer flies in three seconds.
  double fly() {
    const glm::dvec3 before = navigation().pose.position;
    frame = session.step(kStart + 0.01, input_of({key(Kind::key_down, 'W')}));
    for (int i = 1; i <= 30; ++i) frame = session.step(kStart + 0.01 + i * 0.1, input_of({}));
    return glm::length(navigation().pose.position - before);
  }
  [[nodiscard]] const Navigation& navigation() const { return frame.pictures[0].view->navigation; }

  std::shared_ptr<Document> document;
  Session session{{{}, {}, {}, true}, {}, [] {}};
  Frame frame;
};

}  // namespace

TEST_CASE("flies faster from a GeoViewpoint the higher the viewer is, times its speedFactor") {
  const double low = GeoWorld("position 0 0 5").fly(), high = GeoWorld("position 0 0 1000").fly();
  CHECK(low == Approx(3).epsilon(0.1));
  CHECK(high == Approx(300).epsilon(0.1));
  CHECK(GeoWorld("position 0 0 1000 speedFactor 0.5").fly() == Approx(150).epsilon(0.1));
}

TEST_CASE("keeps the horizon level while the viewer flies from a GeoViewpoint around the globe") {
  GeoWorld world("position 0 0 1000000 speedFactor 20");
  CHECK(glm::length(world.navigation().up - glm::vec3(1, 0, 0)) < 1e-6);
  const double way = world.fly();
  CHECK(way > 3e6);
  const Navigation& now = world.navigation();
  const glm::dvec3 up = glm::normalize(now.pose.position);
  CHECK(up.z > 0.3);  // far to the north
  CHECK(glm::dot(glm::dvec3(now.up), up) > 0.9999);
  CHECK(glm::dot(glm::dvec3(now.pose.up()), up) > 0.999);
  CHECK(std::abs(glm::dot(glm::dvec3(now.pose.forward()), up)) < 0.02);
  CHECK(glm::length(now.pose.position) == Approx(kRadius + 1e6).epsilon(0.05));
}

TEST_CASE("turns the viewer about the centerOfRotation of a GeoViewpoint") {
  const GeoWorld world("position 48 11 1000 centerOfRotation 48 11 500");
  const vrml::GeoFrame frame = vrml::GeoFrame::make({vrml::SFString("GD")});
  CHECK(glm::length(world.navigation().center - frame.position({48, 11, 500})) < 1e-3);
}

}  // namespace gs::app::geo_viewpoint_test
