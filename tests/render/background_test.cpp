#include "tests/render/drawing.h"

#include <cmath>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

constexpr float kHalfTurn = 3.14159265f;  // radians

/// Returns a camera at the origin that looks `angle` radians above the horizon.
Camera looking_up(float angle) {
  Camera camera;
  const float c = std::cos(angle), s = std::sin(angle);
  camera.world_from_camera[1] = {0, c, s, 0};
  camera.world_from_camera[2] = {0, -s, c, 0};
  return camera;
}

/// Returns the colour in the direction `from_zenith` radians from the zenith.
glm::vec3 color_at(Drawing& drawing, const Background& background, float from_zenith) {
  RenderList list;
  list.background = background;
  drawing.options.width = drawing.options.height = 65;  // odd, so that the centre of a pixel is the centre of the view
  return pixel(drawing.draw(list, looking_up(kHalfTurn / 2 - from_zenith)), 32, 32);
}

/// Face of the panorama, its view direction and its up direction (VRML97 6.5).
struct Look {
  Background::Face face;
  glm::vec3 ahead, up;
};
// "On the front, back, right and left faces ... with the Y-axis as the view up direction"; "looking along the +Y-axis
// with the +Z-axis as the view up direction"; "along the negative Y-axis with the negative Z-axis".
const Look kLooks[] = {{Background::front, {0, 0, -1}, {0, 1, 0}}, {Background::back, {0, 0, 1}, {0, 1, 0}},
                       {Background::right, {1, 0, 0}, {0, 1, 0}},  {Background::left, {-1, 0, 0}, {0, 1, 0}},
                       {Background::top, {0, 1, 0}, {0, 0, 1}},    {Background::bottom, {0, -1, 0}, {0, 0, -1}}};

/// Returns a camera that sees exactly one face of the panorama.
Camera looking(const Look& look, const glm::vec3& eye = glm::vec3(0)) {
  Camera camera;
  camera.field_of_view = kHalfTurn / 2;
  camera.world_from_camera[0] = glm::vec4(glm::cross(look.ahead, look.up), 0);
  camera.world_from_camera[1] = glm::vec4(look.up, 0);
  camera.world_from_camera[2] = glm::vec4(-look.ahead, 0);
  camera.world_from_camera[3] = glm::vec4(eye, 1);
  return camera;
}

/// Makes an image of two by two pixels: red for the face, green and blue for the corner.
std::shared_ptr<const Image> face_picture(std::size_t face) {
  const auto red = static_cast<std::uint8_t>(40 * face);
  return std::make_shared<const Image>(Image{2, 2, 3, {red, 0, 0, red, 255, 0, red, 0, 255, red, 255, 255}});
}

/// Checks that the picture shows this face, upright and not mirrored.
void check_face(const Image& drawn, std::size_t face) {
  const float red = 40 * static_cast<float>(face) / 255;
  check_color(pixel(drawn, 15, 15), {red, 0, 0}, 9);
  check_color(pixel(drawn, 48, 15), {red, 1, 0}, 9);
  check_color(pixel(drawn, 15, 48), {red, 0, 1}, 9);
  check_color(pixel(drawn, 48, 48), {red, 1, 1}, 9);
}

Background with_panorama() {
  Background background;
  for (std::size_t face = 0; face < Background::kFaces; ++face) background.panorama[face] = face_picture(face);
  return background;
}

}  // namespace

TEST_CASE("interpolates sky colours linearly in the angle from the zenith (VRML97 6.5)") {
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

TEST_CASE("draws the ground over the sky, counted from the nadir (VRML97 6.5)") {
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

TEST_CASE("makes a step of equal angles, and ignores only colours without an angle") {
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

TEST_CASE("turns the background with its node, and replaces it by one chosen colour") {
  Drawing drawing;
  Background background;
  background.sky_colors = {{1, 0, 0}, {0, 0, 1}};
  background.sky_angles = {kHalfTurn};
  // Half a turn about X: the background's zenith is the world's nadir.
  background.world_from_background = glm::mat3(1, 0, 0, 0, -1, 0, 0, 0, -1);
  check_color(color_at(drawing, background, kHalfTurn * 0.25f), {0.25f, 0, 0.75f});
  drawing.options.background = glm::vec3(0, 1, 0);
  check_color(color_at(drawing, background, kHalfTurn * 0.25f), {0, 1, 0});
}

TEST_CASE("draws an off-centre tile of the sky along its view rays") {
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

TEST_CASE("draws each panorama image upright on its face (VRML97 6.5)") {
  Drawing drawing;
  RenderList list;
  list.background = with_panorama();
  for (const Look& look : kLooks) {
    INFO("face " << look.face);
    check_face(drawing.draw(list, looking(look)), look.face);
  }
}

TEST_CASE("joins the panorama at the edges of its cube without gaps") {
  Drawing drawing;
  drawing.options.samples = 4;
  RenderList list;
  list.background.sky_colors = {{1, 0, 1}};
  for (auto& face : list.background.panorama) face = std::make_shared<const Image>(Image{1, 1, 3, {0, 200, 0}});
  for (float up = -1.5f; up < 1.5f; up += 0.37f) {
    Camera camera = looking_up(up);
    const glm::dmat4 turned(glm::dvec4(0.6, 0, 0.8, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(-0.8, 0, 0.6, 0),
                            glm::dvec4(0, 0, 0, 1));
    camera.world_from_camera = turned * camera.world_from_camera;
    camera.field_of_view = 2;
    const Image image = drawing.draw(list, camera);
    std::size_t others = 0;
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) others += pixel(image, x, y) != glm::vec3(0, 200, 0);
    CHECK(others == 0);
  }
}

TEST_CASE("turns the background with its transformation, without moving or scaling it (VRML97 6.5)") {
  Drawing drawing;
  RenderList list;
  list.background = with_panorama();
  const Look& front = kLooks[0];
  check_face(drawing.draw(list, looking(front, {500, -30, 1e6f})), Background::front);
  // A quarter turn about Y moves the front to the left.
  list.background.world_from_background = glm::mat3(0, 0, -1, 0, 1, 0, 1, 0, 0);
  check_face(drawing.draw(list, looking(kLooks[3], {0, 1, 2})), Background::front);
}

TEST_CASE("shows sky and ground through missing and transparent panorama images (VRML97 6.5)") {
  Drawing drawing;
  RenderList list;
  list.background.sky_colors = {{0, 0, 1}};
  list.background.panorama[Background::front] =
      std::make_shared<const Image>(Image{2, 1, 4, {255, 0, 0, 255, 255, 0, 0, 0}});
  list.background.panorama[Background::left] = std::make_shared<const Image>(Image{1, 1, 2, {255, 51}});
  list.background.panorama[Background::right] = std::make_shared<const Image>(Image{1, 1, 1, {102}});
  Image drawn = drawing.draw(list, looking(kLooks[0]));
  check_color(pixel(drawn, 10, 32), {1, 0, 0});
  check_color(pixel(drawn, 54, 32), {0, 0, 1});
  check_color(pixel(drawing.draw(list, looking(kLooks[3])), 32, 32), {0.2f, 0.2f, 1});  // grey with alpha
  check_color(pixel(drawing.draw(list, looking(kLooks[2])), 32, 32), glm::vec3(0.4f));  // grey
  check_color(pixel(drawing.draw(list, looking(kLooks[1])), 32, 32), {0, 0, 1});
  list.background.ground_colors = {{0, 1, 0}, {0, 1, 0}};
  list.background.ground_angles = {1.5f};
  drawn = drawing.draw(list, looking(kLooks[0]));
  check_color(pixel(drawn, 10, 50), {1, 0, 0});
  check_color(pixel(drawn, 54, 50), {0, 1, 0});
  check_color(pixel(drawn, 54, 12), {0, 0, 1});
  drawing.options.background = glm::vec3(1, 1, 0);
  check_color(pixel(drawing.draw(list, looking(kLooks[0])), 10, 32), {1, 1, 0});
}

TEST_CASE("draws the panorama behind everything and without fog (VRML97 6.5, 6.19)") {
  Drawing drawing;
  RenderList list;
  list.background = with_panorama();
  list.fog.visibility_range = 5;
  list.fog.color = {1, 1, 1};
  add(list, glowing(square(0.3f), {0, 0, 0}, translation({0, 0, -3})));
  const Image drawn = drawing.draw(list, looking(kLooks[0]));
  check_color(pixel(drawn, 32, 32), glm::vec3(0.6f), 2.1f);
  check_face(drawn, Background::front);
}
