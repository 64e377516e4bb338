#include "tests/render/drawing.h"

#include <cmath>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

constexpr float kHalfTurn = 3.14159265f;  // radians

/// A camera at the origin that looks `angle` radians above the horizon.
Camera looking_up(float angle) {
  Camera camera;
  const float c = std::cos(angle), s = std::sin(angle);
  camera.world_from_camera[1] = {0, c, s, 0};
  camera.world_from_camera[2] = {0, -s, c, 0};
  return camera;
}

/// The colour in the direction `from_zenith` radians from straight up.
glm::vec3 color_at(Drawing& drawing, const Background& background, float from_zenith) {
  RenderList list;
  list.background = background;
  drawing.options.width = drawing.options.height = 65;  // odd: the middle of a pixel is the middle of the view
  return pixel(drawing.draw(list, looking_up(kHalfTurn / 2 - from_zenith)), 32, 32);
}

}  // namespace

TEST_CASE("Sky colours are interpolated linearly in the angle from the zenith (VRML97 6.5)") {
  Drawing drawing;
  Background background;
  background.sky_colors = {{0, 0, 0.2f}, {0, 0.4f, 1}, {1, 1, 1}};
  background.sky_angles = {1.2f, 1.6f};
  check_color(color_at(drawing, background, 0.001f), {0, 0, 0.2f});
  check_color(color_at(drawing, background, 0.3f), {0, 0.1f, 0.4f});
  check_color(color_at(drawing, background, 0.6f), {0, 0.2f, 0.6f});
  check_color(color_at(drawing, background, 1.2f), {0, 0.4f, 1});
  check_color(color_at(drawing, background, 1.3f), {0.25f, 0.55f, 1});
  check_color(color_at(drawing, background, 2.5f), {1, 1, 1});  // clamped below the last angle
}

TEST_CASE("The ground stands in front of the sky and counts from the nadir (VRML97 6.5)") {
  Drawing drawing;
  Background background;
  background.sky_colors = {{0, 0, 1}};
  background.ground_colors = {{0.1f, 0, 0}, {0.5f, 0.4f, 0}, {0.5f, 0.8f, 0}};
  background.ground_angles = {1.0f, 1.4f};
  check_color(color_at(drawing, background, kHalfTurn - 0.5f), {0.3f, 0.2f, 0});
  check_color(color_at(drawing, background, kHalfTurn - 1.2f), {0.5f, 0.6f, 0});
  check_color(color_at(drawing, background, kHalfTurn - 1.45f),
              {0, 0, 1});  // the sky shows above the last ground angle
  check_color(color_at(drawing, background, 1.0f), {0, 0, 1});
}

TEST_CASE("Equal angles make a step, wrong counts lose only what has no partner") {
  Drawing drawing;
  Background background;
  background.sky_colors = {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  background.sky_angles = {1.0f, 1.0f};
  check_color(color_at(drawing, background, 0.99f), {1, 0, 0});
  check_color(color_at(drawing, background, 1.01f), {0, 1, 0});
  background.sky_angles = {1.0f};
  check_color(color_at(drawing, background, 2.0f), {1, 0, 0});
  background.sky_colors.clear();
  check_color(color_at(drawing, background, 2.0f), {0, 0, 0});
}

TEST_CASE("The background turns with its node and gives way to one colour") {
  Drawing drawing;
  Background background;
  background.sky_colors = {{1, 0, 0}, {0, 0, 1}};
  background.sky_angles = {kHalfTurn};
  // Half a turn about X: the zenith of the background is the nadir of the world.
  background.world_from_background = glm::mat3(1, 0, 0, 0, -1, 0, 0, 0, -1);
  check_color(color_at(drawing, background, kHalfTurn * 0.25f), {0.25f, 0, 0.75f});
  drawing.options.background = glm::vec3(0, 1, 0);
  check_color(color_at(drawing, background, kHalfTurn * 0.25f), {0, 1, 0});
}

TEST_CASE("A picture of the sky follows the view rays off the middle") {
  Drawing drawing;
  RenderList list;
  list.background.sky_colors = {{0, 0, 0}, {1, 1, 1}};
  list.background.sky_angles = {kHalfTurn};
  drawing.options.width = 128;
  drawing.options.height = 64;
  const Image image = drawing.draw(list);
  const float tangent = std::tan(0.785398f / 2);
  for (std::uint32_t y = 3; y < 64; y += 10)
    for (std::uint32_t x = 5; x < 128; x += 30) {
      const glm::vec3 ray((x + 0.5f) / 32 * tangent - 2 * tangent, tangent - (y + 0.5f) / 32 * tangent, -1);
      const float angle = std::acos(ray.y / glm::length(ray));
      check_color(pixel(image, x, y), glm::vec3(angle / kHalfTurn));
    }
}
