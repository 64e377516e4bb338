#include "app/picture/animation.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace gs::app::animation_test {
namespace {

std::vector<AnimationStep> steps_of(const AnimationRequest& request) {
  std::vector<AnimationStep> steps;
  if (const auto problem = plan_animation(request, steps)) FAIL(*problem);
  return steps;
}

}  // namespace

TEST_CASE("turns once around without repeating the first picture") {
  AnimationRequest request;
  request.turntable = true;
  CHECK(steps_of(request).size() == 200);  // 8 seconds at 25 frames
  request.pictures = 4;
  const auto steps = steps_of(request);
  REQUIRE(steps.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) CHECK(steps[i].turned == Approx(static_cast<double>(i) * std::numbers::pi / 2));
  request.times = {2, 6};
  CHECK(steps_of(request)[2].time == 4);
}

TEST_CASE("advances the world's own time evenly, and tours from the first to the last Viewpoint") {
  AnimationRequest request;
  request.times = {1, 3};
  request.rate = 10;
  const auto times = steps_of(request);
  REQUIRE(times.size() == 20);
  CHECK(times[0].time == 1);
  CHECK(times[13].time == Approx(2.3));
  AnimationRequest tour;
  tour.tour = {"A", "B", "C"};
  tour.pictures = 5;
  const auto steps = steps_of(tour);
  REQUIRE(steps.size() == 5);
  CHECK((*steps[0].from == 0 && steps[0].part == 0));
  CHECK((*steps[1].from == 0 && steps[1].part == Approx(0.5)));
  CHECK((*steps[2].from == 1 && steps[2].part == Approx(0)));
  CHECK((*steps[4].from == 1 && steps[4].part == Approx(1)));
  tour.pictures = 0;
  CHECK(steps_of(tour).size() == 150);  // twice three seconds at 25 frames
}

TEST_CASE("refuses animations without movement or without end") {
  std::vector<AnimationStep> steps;
  CHECK(plan_animation({}, steps)->find("nothing would move") != std::string::npos);
  AnimationRequest request;
  request.turntable = true;
  request.tour = {"A", "B"};
  CHECK(plan_animation(request, steps)->find("not both") != std::string::npos);
  request.tour.clear();
  request.pictures = 1'000'000;
  CHECK(plan_animation(request, steps)->find("at most") != std::string::npos);
  request.pictures = 0;
  request.length = 86400;
  request.rate = 240;
  CHECK(plan_animation(request, steps));
}

TEST_CASE("keeps the target and the distance on a turntable") {
  render::Camera camera;
  camera.world_from_camera[3] = {3, 2, 10, 1};
  const glm::dvec3 center(3, 1, 0);
  const render::Camera quarter = turned_camera(camera, center, {0, 1, 0}, std::numbers::pi / 2);
  // Seen from above, objects turn right, so the camera is on their left.
  CHECK(glm::length(glm::dvec3(quarter.world_from_camera[3]) - glm::dvec3(-7, 2, 0)) < 1e-9);
  CHECK(glm::length(-glm::dvec3(quarter.world_from_camera[2]) - glm::dvec3(1, 0, 0)) < 1e-9);
  const render::Camera around = turned_camera(camera, center, {0, 1, 0}, 2 * std::numbers::pi);
  CHECK(glm::length(glm::dvec3(around.world_from_camera[3]) - glm::dvec3(3, 2, 10)) < 1e-9);
}

TEST_CASE("eases the movement between two cameras in and out") {
  render::Camera from, to;
  from.field_of_view = 0.5f;
  to.field_of_view = 1;
  to.world_from_camera[3] = {10, 0, 0, 1};
  CHECK(camera_between(from, to, 0).world_from_camera == from.world_from_camera);
  CHECK(camera_between(from, to, 1).world_from_camera[3].x == 10);
  CHECK(camera_between(from, to, 0.5).world_from_camera[3].x == Approx(5));
  CHECK(camera_between(from, to, 0.5).field_of_view == Approx(0.75f));
  CHECK(camera_between(from, to, 0.01).world_from_camera[3].x < 0.01);
  CHECK(camera_between(from, to, 7).world_from_camera[3].x == 10);
}

}  // namespace gs::app::animation_test
