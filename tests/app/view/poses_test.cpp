#include "app/view/navigation.h"
#include "app/view/picking.h"

#include <catch2/catch.hpp>

#include <glm/geometric.hpp>

#include <cmath>

// Tests of positions for objects with other up axes than VRML97's, and of parallel projection.
namespace gs::app::poses_test {

namespace {

constexpr glm::vec2 kPicture(800, 600);

WideBox box() {
  WideBox bounds;
  bounds.add(glm::vec3(-1, -2, -3));
  bounds.add(glm::vec3(5, 4, 9));
  return bounds;
}

bool close(const glm::dvec3& a, const glm::dvec3& b, double most = 1e-4) { return glm::distance(a, b) < most; }

/// Returns the position of a point in the picture, in halves of its smaller side.
glm::dvec2 seen_at(const Pose& pose, const glm::dvec3& place) {
  const glm::dvec3 p = glm::inverse(glm::dquat(pose.orientation)) * (place - pose.position);
  const double half = pose.height > 0 ? pose.height / 2 : -p.z * std::tan(double{pose.field_of_view} / 2);
  return glm::dvec2(p) / half;
}

bool sees_all(const Pose& pose, const WideBox& bounds) {
  for (int i = 0; i < 8; ++i) {
    const glm::dvec2 at =
        seen_at(pose, {i & 1 ? bounds.upper.x : bounds.lower.x, i & 2 ? bounds.upper.y : bounds.lower.y,
                       i & 4 ? bounds.upper.z : bounds.lower.z});
    if (std::abs(at.y) > 1 || std::abs(at.x) > double{kPicture.x} / kPicture.y) return false;
  }
  return true;
}

Navigation navigation_at(const Pose& pose) {
  NavigationRules rules;
  rules.start = NavigationMode::examine;
  return start_navigation(rules, box(), pose);
}

}  // namespace

TEST_CASE("starts with the up axis on top, seen from the front") {
  for (const UpAxisRow& row : up_axes()) {
    INFO(row.name);
    const Upright upright = upright_of(row.axis);
    const Pose pose = first_pose(box(), kPicture, upright);
    CHECK(sees_all(pose, box()));
    CHECK(close(pose.up(), upright.up));
    CHECK(close(pose.forward(), -upright.front));
    const Pose again = pose_that_fits(pose, box(), kPicture, upright.up);
    CHECK(close(again.position, pose.position, 1e-3));
    CHECK(close(again.up(), upright.up));
  }
  // A plate is seen from above.
  WideBox plate;
  plate.add(glm::vec3(0));
  plate.add(glm::vec3(10, 10, 0.1f));
  CHECK(first_pose(plate, kPicture, upright_of(UpAxis::z)).forward().z < -0.5f);
}

TEST_CASE("starts with flat constructions seen from front, right and above") {
  for (const glm::vec3& size :
       {glm::vec3(10, 10, 10), glm::vec3(10, 10, 3), glm::vec3(10, 0.1f, 10), glm::vec3(0.1f, 9, 9)}) {
    WideBox part;
    part.add(glm::vec3(0));
    part.add(size);
    const Upright upright = upright_of(UpRule::z, size);
    const Pose pose = first_pose(part, kPicture, upright);
    CHECK(sees_all(pose, part));
    const glm::vec3 back = -pose.forward();
    for (const glm::vec3& side : {upright.front, upright.right(), upright.up}) CHECK(glm::dot(back, side) > 0.4f);
    CHECK(std::abs(glm::dot(pose.orientation * glm::vec3(1, 0, 0), upright.up)) < 1e-5f);  // the horizon is level
  }
}

TEST_CASE("shows an object from each side, in perspective and parallel projection") {
  for (const UpAxis axis : {UpAxis::y, UpAxis::z, UpAxis::minus_x}) {
    const Upright upright = upright_of(axis);
    const glm::vec3 right = upright.right();
    const glm::vec3 places[kSideCount] = {upright.front, -upright.front, -right, right, upright.up, -upright.up};
    for (int i = 0; i < kSideCount; ++i)
      for (const double height : {0.0, 1.0}) {
        Pose lens;
        lens.height = height;
        const Pose pose = pose_at_side(static_cast<ViewSide>(i), lens, box(), kPicture, upright);
        CHECK(close(-pose.forward(), places[i]));
        CHECK(sees_all(pose, box()));
        CHECK((pose.height > 0) == (height > 0));
        if (i < 4) CHECK(close(pose.up(), upright.up));
        if (i >= 4) CHECK(close(pose.right(), right));
      }
  }
}

TEST_CASE("levels the roll and nothing else") {
  Pose pose;
  pose.position = {1, 2, 3};
  pose.orientation = glm::normalize(glm::quat(0.3f, 0.5f, -0.2f, 0.7f));
  for (const glm::vec3 up : {glm::vec3(0, 1, 0), glm::vec3(0, 0, -1), glm::normalize(glm::vec3(1, 1, 1))}) {
    const Pose level = straightened(pose, up);
    CHECK(close(level.forward(), pose.forward()));
    CHECK(level.position == pose.position);
    CHECK(std::abs(glm::dot(level.right(), up)) < 1e-5f);
    CHECK(glm::dot(level.up(), up) > 0);
  }
  pose.orientation = {1, 0, 0, 0};
  CHECK(straightened(pose, {0, 0, 1}).orientation == pose.orientation);  // straight down
}

TEST_CASE("moves halfway to a point and looks at it") {
  for (const double height : {0.0, 4.0}) {
    Pose pose;
    pose.position = {0, 0, 20};
    pose.height = height;
    const Navigation sought = seek(navigation_at(pose), {3, 4, 0});
    REQUIRE(sought.transition);
    const Pose& to = sought.transition->to;
    CHECK(close(to.position, {1.5, 2, 10}));
    CHECK(close(to.forward(), glm::normalize(glm::vec3(1.5f, 2, -10))));
    CHECK(to.height == height / 2);
    CHECK(sought.center == glm::dvec3(3, 4, 0));
  }
}

TEST_CASE("keeps the size of the target between parallel projection and perspective") {
  Pose pose;
  pose.position = {2, 3, 10};
  const Pose parallel = with_parallel_rays(pose, true, 7);
  CHECK(parallel.position == pose.position);
  CHECK(std::abs(seen_at(parallel, {3, 3, 3}).x - seen_at(pose, {3, 3, 3}).x) < 1e-6);
  CHECK(std::abs(seen_at(parallel, {3, 3, -30}).x - seen_at(parallel, {3, 3, 3}).x) < 1e-12);
  Pose nearer = parallel;
  nearer.height /= 4;
  const Pose back = with_parallel_rays(nearer, false, 7);
  CHECK(back.height == 0);
  CHECK(std::abs(seen_at(back, {3, 3, 3}).x - seen_at(nearer, {3, 3, 3}).x) < 1e-6);
  CHECK(close(with_parallel_rays(parallel, false, 7).position, pose.position));
}

TEST_CASE("shoots parallel rays through the pixels of their targets") {
  Pose pose = first_pose(box(), kPicture);
  pose.orientation = glm::normalize(glm::quat(0.9f, 0.1f, -0.2f, 0.3f));
  pose.height = 12;
  for (const glm::vec2 pixel : {glm::vec2(0, 0), glm::vec2(400, 300), glm::vec2(799, 10)}) {
    const Ray ray = ray_through(pose, pixel, kPicture);
    CHECK(close(ray.direction, pose.forward()));
    for (const double distance : {0.0, 6e3, 2.4e4}) {
      const glm::dvec2 at = seen_at(pose, ray.at(distance)) * 300.0;
      CHECK(std::abs(at.x - (static_cast<double>(pixel.x) - 400)) < 0.05);
      CHECK(std::abs(at.y + (static_cast<double>(pixel.y) - 300)) < 0.05);
      const auto back = pixel_that_sees(pose, ray.at(distance), kPicture);
      REQUIRE(back);
      CHECK(glm::distance(*back, pixel) < 0.05f);
    }
    const render::SightLine line = sight_line(pose, pixel, kPicture);
    CHECK(close(line.origin, ray.origin, 1e-3));
    CHECK(close(line.direction, glm::dvec3(ray.direction)));
    // Parallel rays also hit points behind the viewer.
    CHECK(glm::dot(pose.position - ray.origin, glm::dvec3(pose.forward())) > 1000);
  }
  Pose perspective = pose;
  perspective.height = 0;
  const auto seen = pixel_that_sees(perspective, ray_through(perspective, {17, 500}, kPicture).at(3), kPicture);
  REQUIRE(seen);
  CHECK(glm::distance(*seen, glm::vec2(17, 500)) < 0.05f);
  CHECK_FALSE(pixel_that_sees(perspective, ray_through(perspective, {17, 500}, kPicture).at(-3), kPicture));
  const Navigation state = navigation_at(pose);
  const glm::dvec3 target = target_of(state, ray_through(pose, {400, 300}, kPicture), std::nullopt);
  CHECK(std::abs(glm::distance(target, pose.position) - looked_at_distance(state)) < 1e-3);
}

TEST_CASE("zooms in parallel projection towards the point under the pointer, which stays") {
  Pose pose;
  pose.position = {0, 0, 30};
  pose.height = 20;
  Navigation state = navigation_at(pose);
  NavigationInput input;
  input.viewport = kPicture;
  input.zoom = 3;
  input.target = glm::dvec3(4, 3, 1);
  const glm::dvec2 before = seen_at(state.pose, *input.target);
  state = step(state, input, 0.01f);
  for (int i = 0; i < 100; ++i) state = step(state, {}, 0.05f);
  CHECK(std::abs(state.pose.height - 20 * std::pow(0.85, 3)) < 0.02);
  CHECK(glm::distance(seen_at(state.pose, *input.target), before) < 1e-3);
}

TEST_CASE("keeps the projection during a movement, whatever projection its end was made for") {
  Pose pose;
  pose.position = {0, 0, 30};
  pose.height = 20;
  Pose end;
  end.position = {0, 0, 15};
  const Navigation way = travel_to(navigation_at(pose), end);
  REQUIRE(way.transition);
  CHECK(way.transition->to.height > 0);
  Pose perspective = pose;
  perspective.height = 0;
  end.height = 3;
  CHECK(travel_to(navigation_at(perspective), end).transition->to.height == 0);
}

}  // namespace gs::app::poses_test
