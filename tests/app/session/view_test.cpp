// Views of worlds that live: what moves in them, their Viewpoints and their time.
#include "app/session/view.h"

#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <chrono>
#include <cmath>

namespace gs::app::view_test {
namespace {

constexpr glm::vec2 kSize(800, 600);

}  // namespace

TEST_CASE("Views follow what lives in their world, whoever looked last") {
  const auto shared = make_document(world_of("DEF T Transform { children Shape { geometry Box { } } }"));
  View one = view_of(shared, kSize, {}), two = view_of(shared, kSize, {});
  const vrml::SceneGraph& scene = *shared->world.scene;
  const auto move = [&](float x) {
    CHECK(shared->living->send(scene, scene.roots()[0], "translation", vrml::SFVec3f{x, 0, 0}));
  };
  move(3);
  CHECK(follow_world(one));
  CHECK(one.list->items.at(0).world_from_node[3].x == 3);
  CHECK(two.list == one.list);
  for (int i = 0; i < 20; ++i) {
    move(static_cast<float>(i));
    (void)shared->living->step(world_time());
  }
  CHECK(follow_world(two));
  CHECK(one.list->items.at(0).world_from_node[3].x == 19);
}

TEST_CASE("Who has bound a Viewpoint moves with it, and goes where events bind another (VRML97 6.53)") {
  const auto shared = make_document(
      world_of("DEF Ship Transform { children [ DEF A Viewpoint { position 0 0 5 } DEF B Viewpoint { position 0 0 9 } "
               "DEF C Viewpoint { position 0 0 -9 jump FALSE } ] }"));
  View view = view_of(shared, kSize, {});
  REQUIRE(view.list->viewpoints.size() == 3);
  CHECK(view.navigation.pose.position == glm::dvec3(0, 0, 5));
  view.navigation.pose.position += glm::dvec3(0, 1, 0);  // he has walked
  const vrml::SceneGraph& scene = *shared->world.scene;
  CHECK(shared->living->send(scene, scene.roots()[0], "translation", vrml::SFVec3f{2, 0, 0}));
  CHECK(follow_world(view));
  CHECK(glm::distance(view.navigation.pose.position, glm::dvec3(2, 1, 5)) < 1e-5f);
  CHECK(shared->living->send(scene, scene.roots()[0], "rotation", vrml::SFRotation{0, 1, 0, 3.14159265f}));
  CHECK(follow_world(view));
  CHECK(glm::distance(view.navigation.pose.position, glm::dvec3(2, 1, -5)) < 1e-4f);
  const auto bind = [&](std::size_t index) {
    const render::ViewpointState& viewpoint = view.list->viewpoints[index];
    CHECK(shared->living->send(*viewpoint.scene, viewpoint.node, "set_bind", vrml::SFBool{true}));
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
  // From then on he moves with that one.
  CHECK(shared->living->send(scene, scene.roots()[0], "translation", vrml::SFVec3f{7, 0, 0}));
  CHECK(follow_world(view));
  CHECK(glm::distance(view.navigation.pose.position, stays + glm::dvec3(5, 0, 0)) < 1e-4f);
}

TEST_CASE("Who chooses a Viewpoint of the list binds it, and travels there (VRML97 6.53)") {
  const auto shared = make_document(world_of("DEF A Viewpoint { } DEF B Viewpoint { position 0 0 50 }"));
  View view = view_of(shared, kSize, {});
  bind_viewpoint(view, 1);
  const vrml::SceneGraph& scene = *shared->world.scene;
  CHECK(shared->living->bound().viewpoint == &scene.node(scene.roots()[1]));
  REQUIRE(view.navigation.transition);
  CHECK(view.navigation.transition->to.position == glm::dvec3(0, 0, 50));
  CHECK_FALSE(follow_bound_viewpoint(view));  // he is on his way already
  bind_viewpoint(view, 7);
  CHECK(view.viewpoint == 1u);
}

TEST_CASE("The NavigationInfo that is bound says how the viewer moves, and what changes in it counts (4.6.10, 6.29)") {
  const auto shared = make_document(
      world_of("DEF A NavigationInfo { type \"WALK\" speed 3 avatarSize [ 1, 2, 0.5 ] } DEF B NavigationInfo { type [ "
               "\"FLY\", \"ANY\" ] headlight FALSE } Transform { scale 2 2 2 children Viewpoint { } } Shape { geometry "
               "Box { } }"));
  View view = view_of(shared, kSize, {});
  CHECK(view.navigation.mode == NavigationMode::walk);
  CHECK(view.navigation.speed == Approx(6));  // in the Viewpoint's metres
  CHECK(view.rules.avatar.radius == 1);
  CHECK(view.rules.avatar.height == 2);
  CHECK(view.rules.avatar.step == 0.5);
  CHECK_FALSE(view.rules.allows(NavigationMode::fly));
  const vrml::SceneGraph& scene = *shared->world.scene;
  CHECK(shared->living->send(scene, scene.roots()[0], "set_speed", vrml::SFFloat{5}));
  CHECK(follow_world(view));
  CHECK(view.navigation.speed == Approx(10));
  CHECK(view.navigation.mode == NavigationMode::walk);
  CHECK(shared->living->send(scene, scene.roots()[1], "set_bind", vrml::SFBool{true}));
  CHECK(follow_world(view));
  CHECK(view.navigation.mode == NavigationMode::fly);
  CHECK(view.rules.allows(NavigationMode::walk));
  CHECK_FALSE(view.headlight);
  CHECK(view.rules.avatar.radius == 0.25);
}

TEST_CASE("Time in a window is that of the clock (VRML97 4.11.3)") {
  const double before = world_time();
  const double clock = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  CHECK(std::abs(clock - before) < 60);  // of a machine whose clock is not set meanwhile
  const auto shared = make_document(world_of("TimeSensor { loop TRUE }"));
  vrml::Execution& execution = shared->living->execution();
  CHECK(execution.now() >= before);
  CHECK(execution.now() <= world_time());
  double last = execution.now();
  std::size_t steps = 0;
  execution.observe([&](const vrml::SentEvent& event) {
    CHECK(event.time > last);
    steps += event.event->name == "time" ? 1 : 0;
  });
  while (world_time() - before < 0.01) {
    (void)shared->living->step(world_time());
    last = execution.now();
  }
  CHECK(steps > 0);
}

}  // namespace gs::app::view_test
