// Tests of Viewpoints of X3D (X3D clause 23).
#include "app/session/viewports/view.h"

#include "tests/app/worlds.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::x3d_view_test {
namespace {

constexpr glm::vec2 kSize(800, 600);

// Returns a document with the node types of X3D.
std::shared_ptr<Document> x3d_document(const std::string& body) {
  LoadedWorld world;
  world.scene = std::make_unique<vrml::SceneGraph>("test.x3dv");
  world.scene->set_language(vrml::Language::x3d, 33);
  Diagnostics diagnostics;
  (void)vrml::Parser(*world.scene, diagnostics).parse_fragment(body);
  REQUIRE(diagnostics.errors() == 0);
  return make_document(std::move(world));
}

const std::string kBox = "Shape { geometry Box { } } ";

}  // namespace

TEST_CASE("shows the rectangle of an OrthoViewpoint in parallel projection (X3D 23.4.5)") {
  const auto document = x3d_document("OrthoViewpoint { fieldOfView [ -2 -1 6 3 ] position 0 0 5 } " + kBox);
  View view = view_of(document, kSize, {});
  CHECK(view.navigation.pose.height == Approx(6));  // 8 units fit into 800 of 600 pixels
  CHECK(view.navigation.pose.position.x == Approx(2));
  CHECK(view.navigation.pose.position.y == Approx(1));
  CHECK(viewpoint_camera(*view.list, view.bound, kSize).height == Approx(6));
  fit_home(view, {400, 400});
  CHECK(view.navigation.pose.height == Approx(8));
}

TEST_CASE("changes between perspective and parallel projection with the bound Viewpoint (X3D 23.3.1)") {
  const auto document = x3d_document("Viewpoint { } OrthoViewpoint { description \"flat\" } " + kBox);
  View view = view_of(document, kSize, {});
  CHECK(view.navigation.pose.height == 0);
  bind_viewpoint(view, 1);
  CHECK(view.navigation.pose.height > 0);
  REQUIRE(view.navigation.transition);
  CHECK(view.navigation.transition->to.height == Approx(2));
  bind_viewpoint(view, 0);
  CHECK(view.navigation.pose.height == 0);
}

TEST_CASE("turns about centerOfRotation of the bound Viewpoint (X3D 23.3.1)") {
  const auto document =
      x3d_document("Viewpoint { centerOfRotation 1 2 3 } Viewpoint { centerOfRotation 4 0 0 } " + kBox);
  View view = view_of(document, kSize, {});
  CHECK(view.navigation.center == glm::dvec3(1, 2, 3));
  bind_viewpoint(view, 1);
  CHECK(view.navigation.center == glm::dvec3(4, 0, 0));
}

TEST_CASE("takes the time of a transition from NavigationInfo, and reports its end (X3D 23.4.4)") {
  const auto document =
      x3d_document("DEF N NavigationInfo { transitionTime 2 } Viewpoint { } Viewpoint { position 9 0 0 } " + kBox);
  View view = view_of(document, kSize, {});
  std::size_t completed = 0;
  document->runtime->execution().cascade().observe(
      [&](const vrml::SentEvent& event) { completed += event.event->name == "transitionComplete" ? 1 : 0; });
  bind_viewpoint(view, 1);
  REQUIRE(view.navigation.transition);
  CHECK(view.navigation.transition->duration == 2);
  (void)follow_world(view);
  CHECK(completed == 0);
  for (int i = 0; i < 9; ++i) view.navigation = step(view.navigation, {}, 0.25f);
  CHECK_FALSE(view.navigation.transition);
  (void)follow_world(view);
  CHECK(completed == 1);
  (void)follow_world(view);
  CHECK(completed == 1);
}

TEST_CASE("moves at once to a Viewpoint with transitionType TELEPORT (X3D 23.4.4)") {
  const auto document =
      x3d_document("NavigationInfo { transitionType \"TELEPORT\" } Viewpoint { } Viewpoint { position 9 0 0 } " + kBox);
  View view = view_of(document, kSize, {});
  bind_viewpoint(view, 1);
  CHECK_FALSE(view.navigation.transition);
  CHECK(view.navigation.pose.position == glm::dvec3(9, 0, 0));
}

TEST_CASE("keeps the user's movements at a Viewpoint with retainUserOffsets (X3D 23.3.1)") {
  const auto document = x3d_document(
      "NavigationInfo { transitionType \"TELEPORT\" } Viewpoint { retainUserOffsets TRUE } Viewpoint { position 9 0 0 "
      "} " +
      kBox);
  View view = view_of(document, kSize, {});
  view.navigation.pose.position.x = 3;
  bind_viewpoint(view, 1);
  view.navigation.pose.position.x = 8;
  bind_viewpoint(view, 0);
  CHECK(view.navigation.pose.position == glm::dvec3(3, 0, 10));
  bind_viewpoint(view, 1);
  CHECK(view.navigation.pose.position == glm::dvec3(9, 0, 0));
}

TEST_CASE("lists the Viewpoints of a ViewpointGroup only if it is displayed (X3D 23.4.7)") {
  const auto document = x3d_document(
      "ViewpointGroup { children [ Viewpoint { description \"a\" } ViewpointGroup { displayed FALSE children Viewpoint "
      "{ description \"b\" } } ] } ViewpointGroup { children OrthoViewpoint { description \"c\" } } " +
      kBox);
  const View view = view_of(document, kSize, {});
  REQUIRE(view.list->viewpoints.size() == 3);
  CHECK(view.bound == &view.list->viewpoints[0].scene->node(view.list->viewpoints[0].node));
  CHECK(listed_viewpoints(view.list->viewpoints) == std::vector<std::size_t>{0, 2});
}

TEST_CASE("lists the Viewpoints of a ViewpointGroup while the viewer is inside of its box (X3D 23.4.7)") {
  const auto document = x3d_document(
      "Viewpoint { description \"a\" } Transform { translation 5 0 0 children ViewpointGroup { description \"hall\" "
      "center 0 1 0 size 2 2 2 children Viewpoint { description \"b\" } } } " +
      kBox);
  const View view = view_of(document, kSize, {});
  const auto& viewpoints = view.list->viewpoints;
  CHECK(listed_viewpoints(viewpoints, {0, 0, 10}) == std::vector<std::size_t>{0});
  CHECK(listed_viewpoints(viewpoints, {5.5, 0.5, 0}) == std::vector<std::size_t>{0, 1});
  CHECK(viewpoint_label(viewpoints[1], 1) == "hall: b");
}

TEST_CASE("draws between nearDistance and farDistance of the bound Viewpoint (X3D 23.3.1)") {
  const auto document = x3d_document(
      "Viewpoint { nearDistance 2 farDistance 50 } Transform { scale 3 3 3 children Viewpoint { farDistance 4 } } "
      "Viewpoint { } " +
      kBox);
  View view = view_of(document, kSize, {});
  CHECK(view.list->near_distance == 2);
  CHECK(view.list->far_distance == 50);
  bind_viewpoint(view, 1);
  CHECK(follow_world(view));
  CHECK(view.list->near_distance == 0);
  CHECK(view.list->far_distance == Approx(12));
  bind_viewpoint(view, 2);
  CHECK(follow_world(view));
  CHECK(view.list->far_distance == 0);
}

TEST_CASE("shows the whole world at a Viewpoint with viewAll (X3D 23.3.1)") {
  const auto document = x3d_document(
      "Viewpoint { viewAll TRUE position 0 0 1 } Transform { translation 50 0 0 children " + kBox + " } " + kBox);
  const View view = view_of(document, kSize, {});
  CHECK(render::has_in_view(camera_of(view.navigation.pose), view.list->bounds, kSize.x, kSize.y));
}

}  // namespace gs::app::x3d_view_test
