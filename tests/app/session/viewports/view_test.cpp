// Tests of views of running worlds: moving geometry, Viewpoints and time.
#include "app/session/viewports/view.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <chrono>
#include <cmath>

namespace gs::app::view_test {
namespace {

constexpr glm::vec2 kSize(800, 600);

}  // namespace

TEST_CASE("updates each view by its own world, whichever view was drawn last") {
  const auto shared = make_document(world_of("DEF T Transform { children Shape { geometry Box { } } }"));
  View one = view_of(shared, kSize, {}), two = view_of(shared, kSize, {});
  const vrml::SceneGraph& scene = *shared->world.scene;
  const auto move = [&](float x) {
    CHECK(shared->runtime->send(scene, scene.roots()[0], "translation", vrml::SFVec3f{x, 0, 0}));
  };
  move(3);
  CHECK(follow_world(one));
  CHECK(one.list->items.at(0).world_from_node[3].x == 3);
  CHECK(two.list == one.list);
  for (int i = 0; i < 20; ++i) {
    move(static_cast<float>(i));
    (void)shared->runtime->step(world_time());
  }
  CHECK(follow_world(two));
  CHECK(one.list->items.at(0).world_from_node[3].x == 19);
}

TEST_CASE("frames the scene again for an unmoved viewer without Viewpoint when geometry leaves the picture") {
  const std::string ball = "DEF T Transform { children Shape { geometry Sphere { } } } ";
  const auto shared = make_document(world_of(ball + "Shape { geometry Box { } }"));
  View view = view_of(shared, kSize, {}), walker = view, far = view;
  walker.navigation.pose.position += glm::dvec3(0.25, 0, 0);
  const vrml::SceneGraph& scene = *shared->world.scene;
  const auto move = [&](View& seen, float x) {
    CHECK(shared->runtime->send(scene, scene.roots()[0], "translation", vrml::SFVec3f{x, 0, 0}));
    CHECK(follow_world(seen));
  };
  const auto sees_all = [](const View& seen) {
    return render::has_in_view(camera_of(seen.home), seen.list->bounds, kSize.x, kSize.y);
  };
  const Pose first = view.home;
  move(view, 0.25f);  // within the margin of the first view
  CHECK(view.home.position == first.position);
  CHECK_FALSE(view.navigation.transition);
  move(view, 6);
  CHECK(view.home.position.z > first.position.z + 1);
  CHECK(view.home.orientation == first.orientation);
  CHECK(sees_all(view));
  REQUIRE(view.navigation.transition);  // during the transition, no new view is chosen
  const Pose aim = view.home;
  CHECK(view.navigation.transition->to.position == aim.position);
  move(view, 40);
  CHECK(view.home.position == aim.position);
  view.navigation = step(view.navigation, {}, 0.3f);
  view.navigation = step(view.navigation, {}, 0.3f);
  CHECK(view.navigation.pose.position == aim.position);
  CHECK(at_home(view));
  move(view, 41);
  CHECK(view.home.position.z > aim.position.z + 10);
  CHECK(sees_all(view));
  CHECK(view.navigation.center.x == Approx(20.5));
  view.navigation.transition.reset();
  view.navigation.pose = view.home;
  // Geometry that returns is already in view, so the camera stays.
  const Pose last = view.home;
  for (const float x : {0.0f, 41.0f, 20.0f}) move(view, x);
  CHECK(view.home.position == last.position);

  // A viewer that the user moved stays. An unmoved viewer does not follow geometry that leaves for good.
  (void)shared->runtime->send(scene, scene.roots()[0], "translation", vrml::SFVec3f{0, 0, 0});
  for (const float x : {6.0f, 41.0f}) move(walker, x);
  CHECK(walker.navigation.pose.position == first.position + glm::dvec3(0.25, 0, 0));
  CHECK_FALSE(walker.navigation.transition);
  move(far, 1e6f);
  CHECK(far.home.position == first.position);
}

TEST_CASE("frames geometry that is added to an empty world without Viewpoint") {
  const auto shared = make_document(world_of("DEF T Transform { children [] translation 300 0 0 }"));
  View view = view_of(shared, kSize, {});
  vrml::SceneGraph& scene = *shared->world.scene;
  Diagnostics diagnostics;
  const auto made =
      shared->runtime->programs().create(scene, "test", "Shape { geometry Sphere { radius 70 } }", diagnostics, &scene);
  REQUIRE(made.roots.size() == 1);
  CHECK(shared->runtime->send(scene, scene.roots()[0], "addChildren", vrml::FieldValue(made.roots)));
  CHECK(follow_world(view));
  REQUIRE_FALSE(view.list->bounds.empty());
  CHECK(view.home.position.x == Approx(300));
  CHECK(render::has_in_view(camera_of(view.home), view.list->bounds, kSize.x, kSize.y));
}

TEST_CASE("moves the viewer with the bound Viewpoint, and to the one that events bind (VRML97 6.53)") {
  const auto shared = make_document(
      world_of("DEF Ship Transform { children [ DEF A Viewpoint { position 0 0 5 } DEF B Viewpoint { position 0 0 9 } "
               "DEF C Viewpoint { position 0 0 -9 jump FALSE } ] }"));
  View view = view_of(shared, kSize, {});
  REQUIRE(view.list->viewpoints.size() == 3);
  CHECK(view.navigation.pose.position == glm::dvec3(0, 0, 5));
  view.navigation.pose.position += glm::dvec3(0, 1, 0);  // the viewer has walked
  const vrml::SceneGraph& scene = *shared->world.scene;
  CHECK(shared->runtime->send(scene, scene.roots()[0], "translation", vrml::SFVec3f{2, 0, 0}));
  CHECK(follow_world(view));
  CHECK(glm::distance(view.navigation.pose.position, glm::dvec3(2, 1, 5)) < 1e-5f);
  CHECK(shared->runtime->send(scene, scene.roots()[0], "rotation", vrml::SFRotation{0, 1, 0, 3.14159265f}));
  CHECK(follow_world(view));
  CHECK(glm::distance(view.navigation.pose.position, glm::dvec3(2, 1, -5)) < 1e-4f);
  const auto bind = [&](std::size_t index) {
    const render::ViewpointState& viewpoint = view.list->viewpoints[index];
    CHECK(shared->runtime->send(*viewpoint.scene, viewpoint.node, "set_bind", vrml::SFBool{true}));
    (void)follow_world(view);
    return follow_bound_viewpoint(view);
  };
  CHECK(bind(1));
  CHECK(view.viewpoint == 1u);
  REQUIRE(view.navigation.transition);
  CHECK(glm::distance(view.navigation.transition->to.position, glm::dvec3(2, 0, -9)) < 1e-4f);
  CHECK_FALSE(follow_bound_viewpoint(view));
  view.navigation.transition.reset();
  const glm::dvec3 stays = view.navigation.pose.position;
  CHECK(bind(2));
  CHECK_FALSE(view.navigation.transition);
  CHECK(view.navigation.pose.position == stays);
  // From then on the viewer moves with the Viewpoint.
  CHECK(shared->runtime->send(scene, scene.roots()[0], "translation", vrml::SFVec3f{7, 0, 0}));
  CHECK(follow_world(view));
  CHECK(glm::distance(view.navigation.pose.position, stays + glm::dvec3(5, 0, 0)) < 1e-4f);
}

namespace {

/// View of a world with Viewpoints of the root or of Transforms, which events bind.
struct Bound {
  explicit Bound(const std::string& body) : shared(make_document(world_of(body))), view(view_of(shared, kSize, {})) {}
  void bind(std::size_t index, bool to_top = true) {
    const render::ViewpointState& viewpoint = view.list->viewpoints[index];
    CHECK(shared->runtime->send(*viewpoint.scene, viewpoint.node, "set_bind", vrml::SFBool{to_top}));
    (void)follow_world(view);
    (void)follow_bound_viewpoint(view);
    if (!view.navigation.transition) return;
    view.navigation.pose = view.navigation.transition->to;
    view.navigation.transition.reset();
  }
  void move_root(std::size_t place, const vrml::SFVec3f& to) {
    const vrml::SceneGraph& scene = *shared->world.scene;
    CHECK(shared->runtime->send(scene, scene.roots()[place], "translation", to));
    (void)follow_world(view);
  }
  void walk(const glm::dvec3& way) { view.navigation.pose.position += way; }
  [[nodiscard]] bool at(const glm::dvec3& place) const {
    return glm::distance(view.navigation.pose.position, place) < 1e-4;
  }

  std::shared_ptr<Document> shared;
  View view;
};

}  // namespace

TEST_CASE("keeps the position relative to a Viewpoint, and restores it when the stack is popped (VRML97 6.53)") {
  Bound world(
      "Transform { children Viewpoint { position 0 0 10 } } Viewpoint { position 50 0 0 } Viewpoint { position 0 90 0 "
      "}");
  world.walk({1, 2, 0});
  world.bind(1);
  CHECK(world.at({50, 0, 0}));
  world.walk({0, 0, 7});
  world.bind(2);
  CHECK(world.at({0, 90, 0}));
  world.move_root(0, {5, 0, 0});  // not bound meanwhile
  world.bind(2, false);
  CHECK(world.at({50, 0, 7}));
  world.bind(1, false);
  CHECK(world.at({6, 2, 10}));  // with the moved Viewpoint
  // A stored position is used for one return only. After that, a bind moves the viewer to the Viewpoint itself.
  world.bind(1);
  CHECK(world.at({50, 0, 0}));
  world.bind(0);
  CHECK(world.at({5, 0, 10}));
}

TEST_CASE("keeps the viewer in place when a Viewpoint with jump FALSE is popped to (VRML97 6.53)") {
  Bound world("Viewpoint { position 0 0 10 } Transform { children Viewpoint { position 50 0 0 jump FALSE } }");
  world.walk({1, 0, 0});
  world.bind(1);
  CHECK(world.at({1, 0, 10}));
  world.move_root(1, {0, 4, 0});
  CHECK(world.at({1, 4, 10}));
  world.bind(1, false);
  CHECK(world.at({1, 4, 10}));
}

TEST_CASE("pops a bound Viewpoint that is deleted like any other (VRML97 4.6.10, 6.53)") {
  Bound world("Viewpoint { position 0 0 10 } Group { children Viewpoint { position 50 0 0 } }");
  world.walk({1, 0, 0});
  world.bind(1);
  CHECK(world.at({50, 0, 0}));
  const vrml::SceneGraph& scene = *world.shared->world.scene;
  CHECK(world.shared->runtime->send(scene, scene.roots()[1], "set_children", vrml::MFNode{}));
  (void)world.shared->runtime->execution().lifetime().remove_unheld();
  (void)follow_world(world.view);
  CHECK(follow_bound_viewpoint(world.view));
  REQUIRE(world.view.navigation.transition);
  CHECK(glm::distance(world.view.navigation.transition->to.position, glm::dvec3(1, 0, 10)) < 1e-4);
}

TEST_CASE("navigates relative to the moving bound Viewpoint, and changes none of its fields (4.13.3)") {
  Bound world("NavigationInfo { type \"FLY\" speed 1 } Transform { children DEF V Viewpoint { position 0 0 10 } }"),
      still("NavigationInfo { type \"FLY\" speed 1 } Transform { children Viewpoint { position 0 0 10 } }");
  NavigationInput held;
  held.viewport = kSize;
  held.move = {0.3f, 0, 1};
  held.turn = {0.2f, 0};
  const vrml::SceneGraph& scene = *world.shared->world.scene;
  for (int i = 1; i <= 30; ++i) {
    for (Bound* each : {&world, &still}) each->view.navigation = step(each->view.navigation, held, 1.0f / 60);
    world.move_root(1, {0.1f * static_cast<float>(i), -0.05f * static_cast<float>(i), 0});
  }
  CHECK(glm::distance(still.view.navigation.pose.position, glm::dvec3(0, 0, 10)) > 0.1);
  CHECK(glm::distance(world.view.navigation.pose.position - glm::dvec3(3, -1.5, 0),
                      still.view.navigation.pose.position) < 1e-4);
  CHECK(glm::distance(world.view.navigation.pose.forward(), still.view.navigation.pose.forward()) < 1e-4f);
  const vrml::NodeId viewpoint = world.view.list->viewpoints[0].node;
  CHECK(scene.get<vrml::SFVec3f>(viewpoint, "position") == vrml::SFVec3f(0, 0, 10));
  CHECK(scene.get<vrml::SFRotation>(viewpoint, "orientation") == vrml::SFRotation{0, 0, 1, 0});
}

TEST_CASE("binds a Viewpoint that is chosen from the list, and moves there (VRML97 6.53)") {
  const auto shared = make_document(world_of("DEF A Viewpoint { } DEF B Viewpoint { position 0 0 50 }"));
  View view = view_of(shared, kSize, {});
  bind_viewpoint(view, 1);
  const vrml::SceneGraph& scene = *shared->world.scene;
  CHECK(shared->runtime->bound().viewpoint == &scene.node(scene.roots()[1]));
  REQUIRE(view.navigation.transition);
  CHECK(view.navigation.transition->to.position == glm::dvec3(0, 0, 50));
  CHECK_FALSE(follow_bound_viewpoint(view));  // already moving
  bind_viewpoint(view, 7);
  CHECK(view.viewpoint == 1u);
}

TEST_CASE("moves as the bound NavigationInfo defines, including changes (4.6.10, 6.29)") {
  const auto shared = make_document(
      world_of("DEF A NavigationInfo { type \"WALK\" speed 3 avatarSize [ 1, 2, 0.5 ] } DEF B NavigationInfo { type [ "
               "\"FLY\", \"ANY\" ] headlight FALSE } Transform { scale 2 2 2 children Viewpoint { } } Shape { geometry "
               "Box { } }"));
  View view = view_of(shared, kSize, {});
  CHECK(view.navigation.mode == NavigationMode::walk);
  CHECK(view.navigation.speed == Approx(6));  // in metres of the Viewpoint
  CHECK(view.rules.avatar.radius == 1);
  CHECK(view.rules.avatar.height == 2);
  CHECK(view.rules.avatar.step == 0.5);
  CHECK_FALSE(view.rules.allows(NavigationMode::fly));
  const vrml::SceneGraph& scene = *shared->world.scene;
  CHECK(shared->runtime->send(scene, scene.roots()[0], "set_speed", vrml::SFFloat{5}));
  CHECK(follow_world(view));
  CHECK(view.navigation.speed == Approx(10));
  CHECK(view.navigation.mode == NavigationMode::walk);
  CHECK(shared->runtime->send(scene, scene.roots()[1], "set_bind", vrml::SFBool{true}));
  CHECK(follow_world(view));
  CHECK(view.navigation.mode == NavigationMode::fly);
  CHECK(view.rules.allows(NavigationMode::walk));
  CHECK_FALSE(view.headlight);
  CHECK(view.rules.avatar.radius == 0.25);
}

TEST_CASE("advances time in a window by the clock (VRML97 4.11.3)") {
  const double before = world_time();
  const double clock = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  CHECK(std::abs(clock - before) < 60);  // if the clock of the machine is not set meanwhile
  const auto shared = make_document(world_of("TimeSensor { loop TRUE }"));
  vrml::Execution& execution = shared->runtime->execution();
  CHECK(execution.now() >= before);
  CHECK(execution.now() <= world_time());
  double last = execution.now();
  std::size_t steps = 0;
  execution.cascade().observe([&](const vrml::SentEvent& event) {
    CHECK(event.time > last);
    steps += event.event->name == "time" ? 1 : 0;
  });
  while (world_time() - before < 0.01) {
    (void)shared->runtime->step(world_time());
    last = execution.now();
  }
  CHECK(steps > 0);
}

}  // namespace gs::app::view_test
