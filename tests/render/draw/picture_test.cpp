#include "render/draw/picture.h"

#include "tests/render/draw/whole_picture.h"
#include "tests/render/drawing.h"
#include "tests/render/geometry_shapes.h"
#include "tests/render/image_difference.h"

#include <cmath>
#include <utility>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace gs::render::picture_test {
namespace {

/// Returns two squares at different depths, a line, and a sky of two colours.
RenderList small_world() {
  RenderList list;
  list.background.sky_colors = {{0.1f, 0.2f, 0.9f}, {0.9f, 0.8f, 0.3f}};
  list.background.sky_angles = {1.7f};
  DrawItem lit;
  lit.mesh = square(2);
  lit.world_from_node = translation({0.7f, 0.3f, -1});
  add(list, lit);
  add(list, glowing(square(0.5f), {1, 0.25f, 0.5f}, translation({-1.3f, 0.9f, 1})));
  DrawItem glass = glowing(square(0.8f), {0, 1, 0}, translation({0.4f, -1.1f, 2}));
  glass.material.transparency = 0.5f;
  add(list, glass);
  return list;
}

Image whole(Drawing& drawing, const RenderList& list, const PictureOptions& options) {
  auto made = draw_whole_picture(drawing.renderer(), list, camera_at({0, 0, 10}), options);
  if (auto* problem = std::get_if<ContextError>(&made)) FAIL(problem->message);
  return std::move(std::get<Image>(made));
}

PictureOptions sized(int width, int height) {
  PictureOptions options;
  options.draw.width = width;
  options.draw.height = height;
  options.draw.samples = 4;
  return options;
}

/// Compares a picture in tiles of 48 pixels with the whole picture.
ImageDifference tiled_against_whole(const RenderList& list, PictureOptions options) {
  Drawing drawing;
  const Image at_once = whole(drawing, list, options);
  options.most_side = 48;
  const Image tiled = whole(drawing, list, options);
  const auto difference = compare(tiled, at_once);
  REQUIRE(std::holds_alternative<ImageDifference>(difference));
  CHECK(compare(at_once, at_once).index() == 0);
  return std::get<ImageDifference>(difference);
}

RenderList geometry_world(qnv::Geometry geometry) {
  RenderList list;
  list.background.sky_colors = {{0.2f, 0.2f, 0.3f}};
  SplatItem item;
  item.geometry = std::make_shared<const qnv::Geometry>(std::move(geometry));
  list.splats.push_back(std::move(item));
  list.bounds.add(glm::vec3(-3));
  list.bounds.add(glm::vec3(3));
  return list;
}

}  // namespace

TEST_CASE("cuts the matrix of a tile out of the matrix of the whole picture") {
  Camera camera = camera_at({0, 0, 10});
  camera.near_plane = 1;
  camera.far_plane = 100;
  const Projection all = projection(camera, 400, 200);
  camera.part = {0, -0.5, 0.5, 1};  // right of the centre
  const Projection part = projection(camera, 100, 150);
  CHECK(whole_size(camera, {100, 150}) == glm::vec2(400, 200));
  for (const glm::vec4& point : {glm::vec4(1, 0.5f, -10, 1), glm::vec4(2, -0.7f, -30, 1)}) {
    const glm::vec4 a = all.clip_from_camera * point, b = part.clip_from_camera * point;
    CHECK(b.x / b.w == Approx(((a.x / a.w) - 0.25f) * 4));
    CHECK(b.y / b.w == Approx(((a.y / a.w) - 0.25f) / 0.75f));
    CHECK(b.z / b.w == Approx(a.z / a.w));
  }
  CHECK(part.tangents().x == Approx(all.tangents().x / 4));
  CHECK(part.center().x == Approx(all.tangents().x / 4));
}

TEST_CASE("draws the same picture in tiles as at once: meshes, glass, sky") {
  const ImageDifference difference = tiled_against_whole(small_world(), sized(130, 101));
  CHECK(difference.psnr > 50);
  CHECK(difference.differing_pixels < 130u * 101 / 100);
}

TEST_CASE("draws the same picture in tiles as at once: splats and volumes", "[optimised]") {
  for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
    PictureOptions options = sized(130, 101);
    options.draw.splats = path;
    CHECK(tiled_against_whole(geometry_world(test::disc_sphere(3000, 3)), options).psnr > 50);
    CHECK(tiled_against_whole(geometry_world(test::random_volume(2000, 3, 0.2f)), options).psnr > 45);
  }
}

TEST_CASE("keeps colours on a transparent background, and blends glass by half") {
  Drawing drawing;
  PictureOptions options = sized(64, 64);
  options.transparent = true;
  RenderList list = small_world();
  const Image image = whole(drawing, list, options);
  REQUIRE(image.components == 4);
  const auto at = [&](std::uint32_t x, std::uint32_t y) { return image.pixels.data() + 4 * (y * 64 + x); };
  CHECK(at(1, 1)[3] == 0);
  // The square is at -1.3, 0.9 and distance 9. There, 32 pixels are 9 tan(pi / 8) units.
  const auto pixel_of = [](float x, float y, float away) {
    const float scale = 32 / (away * std::tan(0.785398f / 2));
    return std::pair{static_cast<std::uint32_t>(32 + x * scale), static_cast<std::uint32_t>(32 - y * scale)};
  };
  const auto [x, y] = pixel_of(-1.3f, 0.9f, 9);
  CHECK(at(x, y)[3] == 255);
  check_color(glm::vec3(at(x, y)[0], at(x, y)[1], at(x, y)[2]), {1, 0.25f, 0.5f});
  const auto [glass_x, glass_y] = pixel_of(0.4f, -1.8f, 8);  // below the large square
  CHECK(std::abs(at(glass_x, glass_y)[3] - 128) <= 1);
  check_color(glm::vec3(at(glass_x, glass_y)[0], at(glass_x, glass_y)[1], at(glass_x, glass_y)[2]), {0, 1, 0}, 3);
}

TEST_CASE("draws points at screen distance at one pixel for both eyes, and others apart by the formula") {
  Camera camera = camera_at({0, 0, 10});
  camera.near_plane = 1;
  camera.far_plane = 100;
  const Eyes eyes = eyes_of(camera, 0.5, 8);
  const auto tangent = [](const Camera& eye, const glm::dvec3& place) {
    const glm::vec4 clip =
        projection(eye, 100, 100).clip_from_camera * glm::vec4(camera_from_world_of(eye) * glm::dvec4(place, 1));
    return static_cast<double>(clip.x / clip.w) * std::tan(0.785398 / 2);
  };
  CHECK(tangent(eyes.left, {0.3, 0, 2}) == Approx(tangent(eyes.right, {0.3, 0, 2})).margin(1e-6));
  // The parallax is e / screen - e / distance.
  CHECK(tangent(eyes.right, {0.3, 0, -10}) - tangent(eyes.left, {0.3, 0, -10}) ==
        Approx(0.5 / 8 - 0.5 / 20).margin(1e-6));
  CHECK(tangent(eyes.right, {0.3, 0, 5}) - tangent(eyes.left, {0.3, 0, 5}) == Approx(0.5 / 8 - 0.5 / 5).margin(1e-6));
}

TEST_CASE("turns both eyes around the point at screen distance in parallel projection") {
  Camera camera = camera_at({0, 0, 10});
  camera.height = 4;
  const Eyes eyes = eyes_of(camera, 0.5, 8);
  const auto right_of = [](const Camera& eye, const glm::dvec3& place) {
    return (camera_from_world_of(eye) * glm::dvec4(place, 1)).x;
  };
  CHECK(right_of(eyes.left, {0, 0, 2}) == Approx(0).margin(1e-9));
  CHECK(right_of(eyes.right, {0, 0, 2}) == Approx(0).margin(1e-9));
  CHECK(eyes.left.world_from_camera[3].x < 0);
  // For the right eye, a point behind the centre moves to the right: per unit, twice the sine of half the angle.
  const double shift = 2 * 10 * std::sin(std::atan(0.25 / 8));
  CHECK(right_of(eyes.right, {0, 0, -8}) - right_of(eyes.left, {0, 0, -8}) == Approx(shift));
  CHECK(right_of(eyes.right, {0, 0, 12}) - right_of(eyes.left, {0, 0, 12}) == Approx(-shift));
}

TEST_CASE("draws stereo pictures side by side or as red-cyan anaglyph") {
  Drawing drawing;
  RenderList list;
  add(list, unlit(square(0.5f), translation({0, 0, 5})));  // white, 5 away
  list.bounds.add(glm::vec3(0, 0, -10));
  list.bounds.add(glm::vec3(0, 0, 5));
  PictureOptions options = sized(200, 100);
  options.stereo = Stereo::side_by_side;
  options.eye_distance = 1;
  options.screen_distance = 10;
  const auto middle_of = [](const Image& image, std::uint32_t from, std::uint32_t to, std::size_t component) {
    double sum = 0, count = 0;
    for (std::uint32_t x = from; x < to; ++x) {
      const double value = image.pixels[(std::size_t{50} * image.width + x) * 3 + component];
      sum += value * (x + 0.5 - from);
      count += value;
    }
    return sum / count;
  };
  const Image halves = whole(drawing, list, options);
  // The tangents differ by -e/10 + e/5 = 0.1. Points before the screen are farther right for the left eye.
  const double pixels = 0.1 / 2 / std::tan(0.785398 / 2) * 50;
  CHECK(middle_of(halves, 0, 100, 0) == Approx(50 + pixels).margin(0.6));
  CHECK(middle_of(halves, 100, 200, 0) == Approx(50 - pixels).margin(0.6));
  options.stereo = Stereo::anaglyph;
  options.draw.width = 100;
  const Image both = whole(drawing, list, options);
  CHECK(middle_of(both, 0, 100, 0) == Approx(50 + pixels).margin(0.6));
  CHECK(middle_of(both, 0, 100, 1) == Approx(50 - pixels).margin(0.6));
  CHECK(middle_of(both, 0, 100, 2) == Approx(50 - pixels).margin(0.6));
}

TEST_CASE("stops a cancelled picture, and refuses one without pixels") {
  Drawing drawing;
  PictureOptions options = sized(64, 130);
  options.most_side = 32;
  std::size_t bands = 0;
  const auto problem =
      draw_picture(drawing.renderer(), small_world(), camera_at({0, 0, 10}), options, [&](Image& band) {
        CHECK(band.height == 32);
        return ++bands < 2;
      });
  CHECK(problem.has_value());
  CHECK(bands == 2);
  CHECK(std::holds_alternative<ContextError>(
      draw_whole_picture(drawing.renderer(), small_world(), camera_at({0, 0, 10}), sized(0, 10))));
}

}  // namespace gs::render::picture_test
