#include "app/view/camera_text.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>
#include <string>

// Tests of cameras as text.
namespace gs::app::camera_text_test {

namespace {

Pose read(const std::string& text) {
  const auto result = read_camera(text);
  INFO(text);
  REQUIRE(std::holds_alternative<Pose>(result));
  return std::get<Pose>(result);
}

bool alike(const Pose& a, const Pose& b) {
  const double size = 1 + glm::length(a.position);
  return glm::distance(a.position, b.position) < 1e-8 * size &&
         std::abs(std::abs(glm::dot(a.orientation, b.orientation)) - 1) < 1e-6f &&
         std::abs(a.field_of_view - b.field_of_view) < 1e-6f && std::abs(a.height - b.height) <= 1e-8 * a.height;
}

}  // namespace

TEST_CASE("restores a camera from its text and from its Viewpoint") {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> number(-1, 1);
  for (int i = 0; i < 200; ++i) {
    Pose pose;
    pose.position = glm::dvec3(number(random), number(random), number(random)) * std::pow(10.0, i % 12 - 3);
    pose.orientation = glm::normalize(glm::quat(number(random), number(random), number(random), number(random)));
    pose.field_of_view = 0.1f + std::abs(number(random)) * 2.5f;
    if (i % 2) pose.height = std::abs(double{number(random)}) * std::pow(10.0, i % 9 - 4) + 1e-6;
    const std::string text = camera_text(pose);
    CHECK(alike(read(text), pose));
    CHECK(camera_text(read(text)).size() < 200);
    Pose perspective = pose;
    perspective.height = 0;
    CHECK(alike(read(viewpoint_text(pose)), perspective));
  }
  CHECK(camera_text(Pose{}) == "position=0,0,10 orientation=0,0,1,0 fieldOfView=0.785398006");
}

TEST_CASE("reads Viewpoints as files contain them, with the standard's defaults") {
  const Pose pose = read(
      "DEF Entry Viewpoint {\n  description \"At the door, 3 = 4\"  # of the house\n  position 1 2.5 -3e1\n"
      "  orientation 0 2 0 3.1415927\n jump FALSE }");
  CHECK(glm::distance(pose.position, glm::dvec3(1, 2.5, -30)) < 1e-9);
  CHECK(glm::distance(pose.forward(), glm::vec3(0, 0, 1)) < 1e-5f);
  CHECK(pose.field_of_view == 0.785398f);
  CHECK(read("height=4").height == 4);
  CHECK(read("position 0 0 10").position == glm::dvec3(0, 0, 10));
}

TEST_CASE("reports invalid camera texts and the expected form") {
  for (const char* bad :
       {"", "Viewpoint { }", "hello", "position=1,2", "position=1,2,x", "position=1,2,3 position=1,2,3",
        "fieldOfView=0", "fieldOfView=4", "height=-1", "orientation=0,0,0,1", "position=1,2,1e300", "position=nan,0,0",
        "description", "\"position"}) {
    INFO(bad);
    const auto result = read_camera(bad);
    REQUIRE(std::holds_alternative<std::string>(result));
    CHECK(std::get<std::string>(result).find("expected position=X,Y,Z") != std::string::npos);
  }
  CHECK(std::holds_alternative<std::string>(read_camera(std::string(100'000, '1'))));
}

}  // namespace gs::app::camera_text_test
