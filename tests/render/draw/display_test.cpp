#include "render/draw/picture.h"
#include "render/draw/renderer.h"
#include "tests/render/draw/whole_picture.h"
#include "tests/render/drawing.h"

#include <catch2/catch.hpp>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <memory>
#include <variant>

// Tests of display modes, the backdrop and guides.
namespace gs::render::display_test {

using namespace gs::render::testing;

namespace {

std::size_t lit_pixels(const Image& image) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += image.components)
    count += image.pixels[i] + image.pixels[i + 1] + image.pixels[i + 2] > 0;
  return count;
}

RenderList one_square() {
  RenderList list;
  add(list, glowing(square(), {1, 1, 1}));
  return list;
}

Camera whole_square() {
  Camera camera = camera_at({0, 0, 10});
  camera.height = 4;
  return camera;
}

}  // namespace

TEST_CASE("draws a square filled, with edges, as wireframe or as points") {
  Drawing drawing;
  const RenderList list = one_square();
  const auto picture = [&](DisplayMode mode) {
    drawing.options.display = mode;
    return drawing.draw(list, whole_square());
  };
  const Image filled = picture(DisplayMode::surface);
  CHECK(lit_pixels(filled) == 32 * 32);
  const Image edges = picture(DisplayMode::edges);
  std::size_t darker = 0, as_before = 0;
  for (std::uint32_t y = 0; y < 64; ++y)
    for (std::uint32_t x = 0; x < 64; ++x) {
      const glm::vec3 before = pixel(filled, x, y), now = pixel(edges, x, y);
      CHECK(now.x <= before.x);
      darker += now.x < before.x;
      as_before += before.x > 0 && now.x == before.x;
    }
  CHECK(darker > 31 * 3);  // the diagonal, and the part of the sides in the square's own pixels
  CHECK(darker < 250);
  CHECK(as_before > 700);
  const Image wire = picture(DisplayMode::wireframe);
  CHECK(lit_pixels(wire) > 31 * 4);
  CHECK(lit_pixels(wire) < 31 * 6 + 20);
  CHECK(pixel(wire, 24, 26) == glm::vec3(0));
  const Image points = picture(DisplayMode::points);
  CHECK(lit_pixels(points) >= 4);
  CHECK(lit_pixels(points) <= 4 * 16);
  // The mode has no effect on the next picture.
  CHECK(picture(DisplayMode::surface).pixels == filled.pixels);
}

TEST_CASE("shows the far side of a solid through its wireframe") {
  Drawing drawing;
  RenderList list = one_square();
  list.items.front().world_from_node = glm::dmat4(glm::rotate(glm::mat4(1), 3.14159265f, glm::vec3(0, 1, 0)));
  CHECK(lit_pixels(drawing.draw(list, whole_square())) == 0);  // its back
  drawing.options.display = DisplayMode::wireframe;
  CHECK(lit_pixels(drawing.draw(list, whole_square())) > 100);
}

TEST_CASE("draws a backdrop that is lighter above, yields to a colour, and joins across tiles") {
  Drawing drawing;
  drawing.options.backdrop = true;
  const RenderList list = one_square();
  const Image image = drawing.draw(list, whole_square());
  CHECK(pixel(image, 2, 1).x > pixel(image, 2, 62).x + 40);
  for (std::uint32_t y = 1; y < 64; ++y) CHECK(pixel(image, 2, y).x <= pixel(image, 2, y - 1).x);
  CHECK(pixel(image, 2, 30) == pixel(image, 61, 30));
  CHECK(pixel(image, 32, 32) == glm::vec3(255));
  PictureOptions options;
  options.draw = drawing.options;
  options.draw.width = options.draw.height = 100;
  const auto at_once = draw_whole_picture(drawing.renderer(), list, whole_square(), options);
  options.most_side = 40;
  const auto in_tiles = draw_whole_picture(drawing.renderer(), list, whole_square(), options);
  int most = 0;
  for (std::uint32_t y = 0; y < 100; ++y)
    most = std::max(most, static_cast<int>(std::abs(pixel(std::get<Image>(at_once), 2, y).x -
                                                    pixel(std::get<Image>(in_tiles), 2, y).x)));
  CHECK(most <= 2);
  drawing.options.background = glm::vec3(0, 0, 1);
  CHECK(pixel(drawing.draw(list, whole_square()), 2, 2) == glm::vec3(0, 0, 255));
}

TEST_CASE("hides guides behind geometry and shows them beside it") {
  Drawing drawing;
  auto guides = std::make_shared<RenderList>();
  auto line = std::make_shared<vrml::Mesh>();
  line->primitive = vrml::Mesh::Primitive::lines;
  line->lit = false;
  line->positions = {{-1.9f, 0.1f, -1}, {1.9f, 0.1f, -1}};
  line->indices = {0, 1};
  line->bounds.add(glm::vec3(-1.9f, 0.1f, -1));
  line->bounds.add(glm::vec3(1.9f, 0.1f, -1));
  add(*guides, glowing(line, {1, 0, 0}));
  drawing.options.guides = guides;
  const Image image = drawing.draw(one_square(), whole_square());
  std::size_t red = 0;
  for (std::uint32_t x = 0; x < 64; ++x)
    for (std::uint32_t y = 25; y < 36; ++y) {
      const glm::vec3 color = pixel(image, x, y);
      red += color.x > 200 && color.y < 50;
      if (x > 17 && x < 46) CHECK(color == glm::vec3(255));
    }
  CHECK(red >= 24);
  CHECK(red < 40);
}

}  // namespace gs::render::display_test
