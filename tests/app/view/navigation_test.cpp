#include "app/view/navigation.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace {

using namespace gs;
using namespace gs::app;

const glm::vec2 kViewport(800, 600);

Box unit_box() {
  Box bounds;
  bounds.add(glm::vec3(-1));
  bounds.add(glm::vec3(1));
  return bounds;
}

Navigation start(NavigationMode mode, float speed = 1) {
  NavigationRules rules;
  rules.allowed.fill(true);
  rules.start = mode;
  rules.speed = speed;
  Pose pose;
  pose.position = {0, 0, 10};
  return start_navigation(rules, unit_box(), pose);
}

NavigationInput idle() {
  NavigationInput input;
  input.viewport = kViewport;
  return input;
}

Navigation run_for(Navigation state, const NavigationInput& input, float seconds, int steps) {
  for (int i = 0; i < steps; ++i) state = step(state, input, seconds / static_cast<float>(steps));
  return state;
}

Navigation settle(Navigation state) {
  for (int i = 0; i < 1000 && state.moving(); ++i) state = step(state, idle(), 0.02f);
  return state;
}

void check_close(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-3f) {
  INFO(a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z);
  CHECK(glm::distance(a, b) < tolerance);
}

void check_valid(const Navigation& state) {
  const Pose& pose = state.pose;
  REQUIRE(std::isfinite(pose.position.x + pose.position.y + pose.position.z));
  REQUIRE(std::abs(glm::length(pose.orientation) - 1) < 1e-4f);
  REQUIRE((pose.field_of_view > 0 && pose.field_of_view < std::numbers::pi_v<float>));
}

render::NavigationState navigation_info(std::vector<std::string> types) {
  render::NavigationState navigation;
  navigation.types = std::move(types);
  return navigation;
}

}  // namespace

TEST_CASE("chooses the mode by NavigationInfo.type (VRML97 6.29)") {
  const NavigationRules standard = navigation_rules(render::NavigationState{});
  CHECK(standard.start == NavigationMode::walk);
  CHECK(standard.allows(NavigationMode::examine));
  CHECK(standard.speed == 1);

  const NavigationRules two = navigation_rules(navigation_info({"EXAMINE", "FLY"}));
  CHECK(two.start == NavigationMode::examine);
  CHECK(two.allows(NavigationMode::fly));
  CHECK_FALSE(two.allows(NavigationMode::walk));
  CHECK_FALSE(two.allows(NavigationMode::pan));

  const NavigationRules unknown_first = navigation_rules(navigation_info({"HOVER", "FLY", "ANY"}));
  CHECK(unknown_first.start == NavigationMode::fly);
  CHECK(unknown_first.allows(NavigationMode::walk));

  const NavigationRules none = navigation_rules(navigation_info({"NONE"}));
  CHECK(none.start == NavigationMode::none);
  CHECK_FALSE(none.allows(NavigationMode::examine));

  const NavigationRules none_any = navigation_rules(navigation_info({"NONE", "ANY"}));
  CHECK(none_any.start == NavigationMode::none);
  CHECK(none_any.allows(NavigationMode::examine));

  CHECK(navigation_rules(navigation_info({"ANY"})).start == NavigationMode::examine);
  CHECK(navigation_rules(navigation_info({})).start == NavigationMode::walk);
  CHECK(navigation_rules(navigation_info({"HOVER"})).allows(NavigationMode::fly));
}

TEST_CASE("examines a world without NavigationInfo, or walks in it if it has a Viewpoint") {
  CHECK(default_navigation_rules(unit_box(), false).start == NavigationMode::examine);
  CHECK(default_navigation_rules(unit_box(), true).start == NavigationMode::walk);
  CHECK(default_navigation_rules(unit_box(), true).speed == Approx(std::sqrt(12.0f) / 8));
  CHECK(default_navigation_rules({}, false).speed == 1);
}

TEST_CASE("EXAMINE turns about the centre and keeps its distance") {
  Navigation state = start(NavigationMode::examine);
  NavigationInput drag = idle();
  drag.drag = Drag::rotate;
  drag.moved = {-300, 0};  // half of the smaller side is a quarter turn
  state = step(state, drag, 0.01f);
  check_close(state.pose.position, {10, 0, 0});
  check_close(state.pose.forward(), {-1, 0, 0});
  check_close(state.pose.up(), {0, 1, 0});
  drag.moved = {0, 300};
  state = step(state, drag, 0.01f);
  check_close(state.pose.position, {0, 10, 0});
  check_close(state.pose.forward(), {0, -1, 0});
}

TEST_CASE("EXAMINE turns about any centre as a rigid body") {
  Navigation state = start(NavigationMode::examine);
  state.center = {3, 1, -2};
  const glm::vec3 before = glm::inverse(state.pose.orientation) * glm::vec3(state.center - state.pose.position);
  NavigationInput drag = idle();
  drag.drag = Drag::rotate;
  drag.moved = {37, -91};
  for (int i = 0; i < 200; ++i) state = step(state, drag, 0.01f);
  check_close(glm::inverse(state.pose.orientation) * glm::vec3(state.center - state.pose.position), before, 0.01f);
}

TEST_CASE("keeps a panned point under the pointer") {
  Navigation state = start(NavigationMode::examine);
  const glm::vec3 target(0.5f, 0.25f, 1);
  const glm::vec2 pointer(420, 250), moved(130, -70);
  const auto project = [](const Pose& pose, const glm::vec3& point) {
    const glm::vec3 p = glm::inverse(pose.orientation) * glm::vec3(glm::dvec3(point) - pose.position);
    return glm::vec2(p.x, -p.y) / -p.z / std::tan(pose.field_of_view / 2) * 300.0f + kViewport / 2.0f;
  };
  const glm::vec2 before = project(state.pose, target);
  NavigationInput drag = idle();
  drag.drag = Drag::pan;
  drag.moved = moved;
  drag.target = target;
  state = step(state, drag, 0.01f);
  CHECK(glm::distance(project(state.pose, target), before + moved) < 0.1f);
}

TEST_CASE("moves by 15 % per notch of the wheel towards the target, and back again") {
  const Navigation first = start(NavigationMode::examine);
  NavigationInput wheel = idle();
  wheel.zoom = 1;
  wheel.target = glm::vec3(2, 1, 0);
  const Navigation nearer = settle(step(first, wheel, 0.016f));
  check_close(nearer.pose.position, *wheel.target + (first.pose.position - *wheel.target) * 0.85);
  check_close(nearer.pose.forward(), first.pose.forward());
  wheel.zoom = -1;
  check_close(settle(step(nearer, wheel, 0.016f)).pose.position, first.pose.position);
  wheel.zoom = 1e9f;
  Navigation state = first;
  for (int i = 0; i < 100; ++i) state = settle(step(state, wheel, 0.016f));
  CHECK(glm::distance(state.pose.position, *wheel.target) > 0);
  check_valid(state);
}

TEST_CASE("FLY moves along the view direction at the speed of the NavigationInfo") {
  Navigation state = start(NavigationMode::fly, 3);
  state.pose.orientation = glm::angleAxis(0.5f, glm::vec3(1, 0, 0));
  NavigationInput keys = idle();
  keys.move = {0, 0, 1};
  state = settle(run_for(state, keys, 2, 120));
  const glm::vec3 way(state.pose.position - glm::dvec3(0, 0, 10));
  CHECK(glm::length(way) == Approx(6).margin(0.05));  // the end makes up for the slow start
  check_close(glm::normalize(way), {0, std::sin(0.5f), -std::cos(0.5f)});
}

TEST_CASE("quadruples the speed with Shift, and stays at speed 0") {
  NavigationInput keys = idle();
  keys.move = {0, 0, 1};
  keys.fast = true;
  CHECK(settle(run_for(start(NavigationMode::fly, 1), keys, 1, 60)).pose.position.z == Approx(6).margin(0.05));
  CHECK(settle(run_for(start(NavigationMode::fly, 0), keys, 1, 60)).pose.position.z == 10);
}

TEST_CASE("WALK stays level, without change of height and roll") {
  Navigation state = start(NavigationMode::walk, 2);
  state.pose.orientation = glm::angleAxis(-0.6f, glm::vec3(1, 0, 0));  // looking down
  NavigationInput input = idle();
  input.move = {0.5f, 0, 1};
  input.turn = {0.7f, 0};
  input.drag = Drag::look;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> pixels(-40, 40);
  for (int i = 0; i < 2000; ++i) {
    input.moved = {pixels(random), pixels(random)};
    state = step(state, input, 0.016f);
    REQUIRE(std::abs(state.pose.position.y) < 1e-3f);
    REQUIRE(std::abs(state.pose.right().y) < 1e-3f);
    REQUIRE(state.pose.up().y > 0);
  }
}

TEST_CASE("WALK straightens a rolled Viewpoint while it moves") {
  Navigation state = start(NavigationMode::walk);
  state.pose.orientation = glm::angleAxis(0.8f, glm::vec3(0, 0, 1));
  NavigationInput keys = idle();
  keys.move = {0, 0, 1};
  const float before = std::abs(state.pose.right().y);
  const Navigation soon = run_for(state, keys, 0.1f, 6);
  CHECK(std::abs(soon.pose.right().y) < before);
  CHECK(std::abs(soon.pose.right().y) > 0.1f);
  CHECK(std::abs(run_for(state, keys, 2, 120).pose.right().y) < 1e-3f);
  check_close(run_for(state, keys, 2, 120).pose.forward(), {0, 0, -1});
}

TEST_CASE("WALK finds a forward direction from a view straight down") {
  Navigation state = start(NavigationMode::walk);
  state.pose.orientation =
      glm::angleAxis(-std::numbers::pi_v<float> / 2, glm::vec3(1, 0, 0));  // the top of the view is -Z
  NavigationInput keys = idle();
  keys.turn = {0, 1};
  state = run_for(state, keys, 1, 60);
  CHECK(state.pose.forward().z < 0);
  check_valid(state);
}

TEST_CASE("moves equally at any frame rate") {
  for (const NavigationMode mode :
       {NavigationMode::examine, NavigationMode::fly, NavigationMode::walk, NavigationMode::pan}) {
    INFO(row_of(mode).label);
    NavigationInput keys = idle();
    keys.move = {0.3f, 0.2f, 1};
    keys.turn = {0.8f, 0.3f};
    const Navigation slow = run_for(start(mode), keys, 1.5f, 30);
    const Navigation fast = run_for(start(mode), keys, 1.5f, 600);
    check_close(slow.pose.position, fast.pose.position, 0.02f);
    check_close(slow.pose.forward(), fast.pose.forward(), 0.01f);

    NavigationInput wheel = idle();
    wheel.zoom = 3;
    const Navigation rolled = step(start(mode), wheel, 0);
    check_close(run_for(rolled, idle(), 0.3f, 5).pose.position, run_for(rolled, idle(), 0.3f, 100).pose.position,
                0.01f);
  }
}

TEST_CASE("leaves the viewer to the world in mode NONE") {
  NavigationInput input = idle();
  input.drag = Drag::rotate;
  input.moved = {100, 50};
  input.move = {1, 1, 1};
  input.zoom = 5;
  const Navigation state = run_for(start(NavigationMode::none), input, 1, 60);
  check_close(state.pose.position, {0, 0, 10}, 1e-6f);
  for (const DragButton button : {DragButton::left, DragButton::right, DragButton::middle})
    CHECK(drag_of(NavigationMode::none, button, false) == Drag::none);
  Pose there;
  there.position = {5, 0, 0};
  CHECK(run_for(travel_to(state, there), input, 1, 60).pose.position.x == 5);  // a Viewpoint remains bound
}

TEST_CASE("moves smoothly to a Viewpoint in 0.4 seconds, and ends exactly") {
  const Navigation state = start(NavigationMode::examine);
  const Pose there =
      pose_of(glm::translate(glm::mat4(1), {4, 2, 0}) * glm::rotate(glm::mat4(1), 1.2f, glm::vec3(0, 1, 0)), 0.5f);
  Navigation on_the_way = travel_to(state, there);
  CHECK(on_the_way.moving());
  on_the_way = run_for(on_the_way, idle(), 0.2f, 10);
  check_close(on_the_way.pose.position, glm::vec3(2, 1, 5), 0.01f);
  const Navigation arrived = run_for(on_the_way, idle(), 0.25f, 10);
  CHECK_FALSE(arrived.moving());
  CHECK(arrived.pose.position == there.position);
  CHECK(arrived.pose.field_of_view == 0.5f);

  NavigationInput drag = idle();
  drag.drag = Drag::rotate;
  drag.moved = {1, 0};
  CHECK_FALSE(step(on_the_way, drag, 0.01f).transition);  // user input precedes the transition
}

TEST_CASE("centres the point of a double click") {
  const glm::dvec3 point(1, 0.5, 0.2);
  const Navigation state = run_for(look_at_point(start(NavigationMode::examine), point), idle(), 0.5f, 30);
  CHECK(state.center == point);
  check_close(glm::vec3(glm::normalize(point - state.pose.position)), state.pose.forward());
  check_close(state.pose.forward(), {0, 0, -1});
}

TEST_CASE("frames the whole from +Z without a Viewpoint, and after fitting") {
  const auto sees_all = [](const Pose& pose) {
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec3 point(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const glm::vec3 p = glm::inverse(pose.orientation) * glm::vec3(glm::dvec3(point) - pose.position);
      const float limit = std::tan(pose.field_of_view / 2) * -p.z;
      if (p.z >= 0 || std::abs(p.y) > limit || std::abs(p.x) > limit * 800 / 600) return false;
    }
    return true;
  };
  const Pose first = first_pose(unit_box(), kViewport);
  check_close(first.forward(), {0, 0, -1});
  CHECK(sees_all(first));
  Pose rolled;
  rolled.orientation = glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, 3)));
  const Pose fitted = pose_that_fits(rolled, unit_box(), kViewport);
  CHECK(sees_all(fitted));
  check_close(fitted.forward(), rolled.forward());
  CHECK(std::abs(fitted.right().y) < 1e-4f);
  CHECK(pose_that_fits(rolled, {}, kViewport).position == rolled.position);
}

TEST_CASE("makes a valid pose of any matrix") {
  const glm::mat4 scaled = glm::scale(glm::translate(glm::mat4(1), {1, 2, 3}), glm::vec3(2, 3, 4));
  const Pose pose = pose_of(scaled, 0.7f);
  check_close(pose.position, {1, 2, 3});
  check_close(pose.forward(), {0, 0, -1});
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const float bad : {0.0f, nan, inf, -inf, 1e38f, 1e-38f}) {
    Navigation state = start(NavigationMode::examine);
    state.pose = pose_of(glm::mat4(bad), bad);
    check_valid(state);
    glm::mat4 partly(1.0f);
    partly[1] = glm::vec4(0, 0, bad, 0);
    state.pose = pose_of(partly, 1);
    check_valid(state);
  }
  const render::Camera camera = camera_of(pose);
  CHECK(camera.world_from_camera[3] == glm::dvec4(1, 2, 3, 1));
  CHECK(camera.near_plane == 0);
}

TEST_CASE("keeps the viewer valid for any input") {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const float values[] = {0, 1, -1, nan, inf, -inf, 1e38f, -1e38f, 1e-38f, 500};
  std::mt19937 random(7);
  const auto any = [&] { return values[random() % std::size(values)]; };
  const Drag drags[] = {Drag::none, Drag::rotate, Drag::pan, Drag::zoom, Drag::look, Drag::travel};
  for (int round = 0; round < 40; ++round) {
    Box bounds;
    bounds.lower = {any(), any(), any()};
    bounds.upper = {any(), any(), any()};
    NavigationRules rules;
    rules.start = static_cast<NavigationMode>(round % kNavigationModeCount);
    rules.speed = any();
    Navigation state = start_navigation(rules, bounds, pose_of(glm::mat4(1), 0.7f));
    for (int i = 0; i < 400; ++i) {
      NavigationInput input;
      input.viewport = {any(), any()};
      input.drag = drags[random() % std::size(drags)];
      input.moved = {any(), any()};
      input.from_press = {any(), any()};
      input.zoom = any();
      input.move = {any(), any(), any()};
      input.turn = {any(), any()};
      if (random() % 2) input.target = glm::vec3(any(), any(), any());
      if (random() % 50 == 0) state = look_at_point(state, {any(), any(), any()});
      if (random() % 50 == 0)
        state = travel_to(state, Pose{{any(), any(), any()}, {any(), any(), any(), any()}, any()});
      state = step(state, input, random() % 3 ? 0.016f : any());
      check_valid(state);
    }
  }
}

TEST_CASE("shoots a ray through its pixel") {
  Pose pose;
  pose.position = {1, 2, 3};
  pose.field_of_view = std::numbers::pi_v<float> / 2;
  check_close(ray_through(pose, kViewport / 2.0f, kViewport).direction, {0, 0, -1});
  // The smaller side spans the field of view: its upper edge is 45 degrees up.
  check_close(ray_through(pose, {400, 0}, kViewport).direction, glm::normalize(glm::vec3(0, 1, -1)));
  check_close(ray_through(pose, {700, 300}, kViewport).direction, glm::normalize(glm::vec3(1, 0, -1)));
  CHECK(ray_through(pose, {400, 0}, kViewport).origin == pose.position);
}

TEST_CASE("maps drags to movements by mode and button") {
  CHECK(drag_of(NavigationMode::examine, DragButton::left, false) == Drag::rotate);
  CHECK(drag_of(NavigationMode::examine, DragButton::left, true) == Drag::pan);
  CHECK(drag_of(NavigationMode::examine, DragButton::right, false) == Drag::pan);
  CHECK(drag_of(NavigationMode::examine, DragButton::middle, false) == Drag::pan);
  CHECK(drag_of(NavigationMode::examine, DragButton::right, true) == Drag::zoom);
  CHECK(drag_of(NavigationMode::examine, DragButton::middle, true) == Drag::zoom);
  CHECK(drag_of(NavigationMode::walk, DragButton::left, false) == Drag::travel);
  CHECK(drag_of(NavigationMode::fly, DragButton::right, false) == Drag::look);
  CHECK(drag_of(NavigationMode::pan, DragButton::left, false) == Drag::pan);
}

TEST_CASE("moves ahead and turns by a travelling drag, and rests near its start") {
  NavigationInput drag = idle();
  drag.drag = Drag::travel;
  drag.from_press = {0, -100};
  CHECK(run_for(start(NavigationMode::walk), drag, 1, 60).pose.position.z < 9.7f);
  drag.from_press = {100, 0};
  CHECK(run_for(start(NavigationMode::walk), drag, 1, 60).pose.forward().x > 0.2f);
  drag.from_press = {1, -1};
  CHECK(run_for(start(NavigationMode::walk), drag, 1, 60).pose.position.z == 10);
}

TEST_CASE("lists Viewpoints (VRML97 6.53)") {
  std::vector<render::ViewpointState> viewpoints(4);
  viewpoints[1].description = "Front door";
  viewpoints[2].name = "HIDDEN";
  viewpoints[3].description = "3";
  CHECK(listed_viewpoints(viewpoints) == std::vector<std::size_t>{0, 1, 3});
  CHECK(listed_viewpoints({}).empty());
  CHECK(viewpoint_label(viewpoints[0], 0) == "Viewpoint 1");
  CHECK(viewpoint_label(viewpoints[1], 1) == "Front door");
  CHECK(viewpoint_label(viewpoints[2], 2) == "HIDDEN");
  CHECK(find_viewpoint(viewpoints, "Front door") == 1u);
  CHECK(find_viewpoint(viewpoints, "HIDDEN") == 2u);
  CHECK(find_viewpoint(viewpoints, "3") == 3u);  // a description precedes a number
  CHECK(find_viewpoint(viewpoints, "2") == 1u);
  CHECK_FALSE(find_viewpoint(viewpoints, "0"));
  CHECK_FALSE(find_viewpoint(viewpoints, "5"));
  CHECK_FALSE(find_viewpoint(viewpoints, "-1"));
  CHECK_FALSE(find_viewpoint(viewpoints, "99999999999999999999999"));
}
