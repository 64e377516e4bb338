#include "render/draw/picture.h"
#include "render/draw/renderer.h"
#include "tests/render/draw/whole_picture.h"
#include "tests/render/drawing.h"
#include "tests/render/geometry_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <variant>

// Tests of parallel projection, compared with a distant camera with a narrow lens.
namespace gs::render::orthographic_test {

using namespace gs::render::testing;

namespace {

constexpr double kFar = 400;  // distance of the narrow lens

Camera parallel_at(const glm::vec3& eye, double height) {
  Camera camera = camera_at(eye);
  camera.height = height;
  return camera;
}

/// Returns a perspective camera with a narrow lens. At z = 0 it shows about as much as a parallel camera.
Camera narrow(double height) {
  Camera camera = camera_at({0, 0, static_cast<float>(kFar)});
  camera.field_of_view = static_cast<float>(2 * std::atan(height / 2 / kFar));
  return camera;
}

std::size_t differing(const Image& a, const Image& b, int most) {
  REQUIRE(a.pixels.size() == b.pixels.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); i += a.components) {
    int difference = 0;
    for (std::size_t c = 0; c < 3; ++c)
      difference = std::max(difference, std::abs(int{a.pixels[i + c]} - int{b.pixels[i + c]}));
    count += difference > most;
  }
  return count;
}

std::size_t lit_pixels(const Image& image) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += image.components)
    count += image.pixels[i] + image.pixels[i + 1] + image.pixels[i + 2] > 0;
  return count;
}

DrawItem shiny_square(const glm::mat4& place) {
  DrawItem item;
  item.mesh = square();
  item.world_from_node = place;
  item.material.diffuse = {0.5f, 0.3f, 0.2f};
  item.material.specular = {0.6f, 0.6f, 0.6f};
  item.material.shininess = 0.3f;
  return item;
}

std::shared_ptr<const qnv::Geometry> shared(qnv::Geometry geometry) {
  return std::make_shared<const qnv::Geometry>(std::move(geometry));
}

void add_vectors(RenderList& list, qnv::Geometry geometry) {
  Box bounds;
  for (const glm::vec3& position : qnv::VectorView(geometry).positions) bounds.add(position);
  list.bounds.add(bounds);
  SplatItem item;
  item.geometry = shared(std::move(geometry));
  list.splats.push_back(std::move(item));
}

}  // namespace

TEST_CASE("keeps sizes at any distance in parallel projection, also behind the viewer") {
  Drawing drawing;
  for (const float z : {-300.0f, -3.0f, 0.0f, 5.0f, 40.0f}) {
    RenderList list;
    add(list, glowing(square(), {1, 1, 1}, translation({0, 0, z})));
    const Image image = drawing.draw(list, parallel_at({0, 0, 10}, 4));
    INFO(z);
    CHECK(lit_pixels(image) == 32 * 32);
    CHECK(pixel(image, 16, 16) == glm::vec3(255));
    CHECK(pixel(image, 15, 16) == glm::vec3(0));
  }
}

TEST_CASE("resolves depth in parallel projection however close meshes are") {
  Drawing drawing;
  // A view of two metres in a scene of thousands of metres. A distant perspective camera could not resolve their
  // depths.
  RenderList list;
  add(list, glowing(square(), {0, 1, 0}, translation({0, 0, 0.02f})));
  add(list, glowing(square(), {1, 0, 0}));
  add(list, glowing(square(), {0, 0, 1}, translation({0, 0, -2000})));
  add(list, glowing(square(0.1f), {1, 1, 1}, translation({0.9f, 0.9f, 1000})));
  const Image image = drawing.draw(list, parallel_at({0, 0, 10}, 2));
  CHECK(pixel(image, 32, 32) == glm::vec3(0, 255, 0));
  CHECK(pixel(image, 60, 3) == glm::vec3(255));
  // Outside the view at the side: invisible.
  CHECK(lit_pixels(drawing.draw(list, parallel_at({5, 0, 10}, 2))) == 0);
}

TEST_CASE("matches a distant narrow lens in parallel projection for meshes, highlights and point lights") {
  Drawing drawing;
  drawing.options.width = 96;
  RenderList list;
  for (int i = 0; i < 5; ++i) {
    glm::mat4 place = translation({0.6f * static_cast<float>(i) - 1.2f, 0.3f * static_cast<float>(i % 3), 0.5f * i});
    place = glm::rotate(place, 0.3f * static_cast<float>(i), glm::vec3(1, 1, 0)) * scale(glm::vec3(0.7f));
    add(list, shiny_square(place));
  }
  Light lamp;
  lamp.kind = Light::Kind::point;
  lamp.location = {1, 2, 4};
  lamp.radius = 100;
  list.lights.push_back(lamp);
  const Image parallel = drawing.draw(list, parallel_at({0, 0, 10}, 3)), far = drawing.draw(list, narrow(3));
  CHECK(lit_pixels(parallel) > 1000);
  CHECK(differing(parallel, far, 4) < 60);  // edges
}

TEST_CASE("matches a distant narrow lens in parallel projection for splats and volumes, on both paths") {
  for (const SplatPath path : {SplatPath::gl, SplatPath::cpu}) {
    Drawing drawing;
    drawing.options.splats = path;
    RenderList discs;
    add_vectors(discs, gs::test::disc_sphere(4000, 1));
    const Image parallel = drawing.draw(discs, parallel_at({0, 0, 10}, 3)), far = drawing.draw(discs, narrow(3));
    CHECK(lit_pixels(parallel) > 1000);
    CHECK(differing(parallel, far, 12) < 80);
    RenderList fog;
    add_vectors(fog, gs::test::random_volume(2000, 5, 0.1f));
    const Image geometry = drawing.draw(fog, parallel_at({0, 0, 10}, 3)), far_image = drawing.draw(fog, narrow(3));
    CHECK(lit_pixels(geometry) > 100);
    CHECK(differing(geometry, far_image, 12) < 80);
  }
}

TEST_CASE("draws equal tiles in parallel projection") {
  Drawing drawing;
  RenderList list;
  for (int i = 0; i < 5; ++i)
    add(list, shiny_square(translation({static_cast<float>(i) - 2, 0.2f * static_cast<float>(i), -2.0f * i})));
  add_vectors(list, gs::test::disc_sphere(2000, 1, {0, -0.5f, 0}));
  PictureOptions options;
  options.draw = drawing.options;
  options.draw.width = options.draw.height = 96;
  const Camera camera = parallel_at({0, 0, 10}, 5);
  const auto at_once = draw_whole_picture(drawing.renderer(), list, camera, options);
  options.most_side = 40;
  const auto in_tiles = draw_whole_picture(drawing.renderer(), list, camera, options);
  REQUIRE(std::holds_alternative<Image>(at_once));
  REQUIRE(std::holds_alternative<Image>(in_tiles));
  CHECK(differing(std::get<Image>(at_once), std::get<Image>(in_tiles), 8) < 60);
}

TEST_CASE("begins fog at the viewer in parallel projection") {
  Drawing drawing;
  RenderList list;
  list.fog.color = {1, 0, 0};
  list.fog.visibility_range = 20;
  add(list, glowing(square(), {0, 1, 0}));
  const glm::vec3 in_perspective = pixel(drawing.draw(list), 32, 32);
  const glm::vec3 parallel = pixel(drawing.draw(list, parallel_at({0, 0, 10}, 4)), 32, 32);
  check_color(parallel, in_perspective / 255.0f, 2);
  CHECK(parallel.x > 100);
  CHECK(parallel.y > 100);
}

TEST_CASE("draws the sky in parallel projection as in perspective") {
  Drawing drawing;
  RenderList list;
  list.background.sky_colors = {{0, 0, 1}, {1, 1, 1}};
  list.background.sky_angles = {1.5708f};
  CHECK(differing(drawing.draw(list), drawing.draw(list, parallel_at({0, 0, 10}, 4)), 1) == 0);
}

TEST_CASE("shows the centre of the scene in the requested size from a distant camera") {
  Box bounds;
  bounds.add(glm::vec3(-1, -1, -30));
  bounds.add(glm::vec3(1, 1, 10));
  const Camera camera = far_camera(parallel_at({0, 0, 4}, 8), bounds);
  CHECK(camera.height == 0);
  const double distance = camera.world_from_camera[3].z + 10;  // to z = -10
  CHECK(std::abs(2 * std::tan(camera.field_of_view / 2.0) * distance - 8) < 1e-3);
  CHECK(std::abs(camera.world_from_camera[3].z - 4 - camera.back) < 1e-6);
  CHECK(20 / distance <= 2 * kFarParallax);
  const Camera perspective = camera_at({1, 2, 3});
  CHECK(far_camera(perspective, bounds).world_from_camera == perspective.world_from_camera);
}

}  // namespace gs::render::orthographic_test
