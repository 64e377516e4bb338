#include "tests/render/drawing.h"

#include <cstdint>
#include <memory>
#include <utility>

// Tests of pictures of several layers (X3D 35.2.2).
namespace gs::render::testing {
namespace {

constexpr std::uint32_t kSide = 64;

/// Returns a list with a square that fills the picture of a camera at (0, 0, 10).
std::shared_ptr<RenderList> filled(const glm::vec3& color, const vrml::ClipBoundary& boundary, float half = 20) {
  auto list = std::make_shared<RenderList>();
  add(*list, glowing(square(half), color));
  list->boundary = boundary;
  return list;
}

RenderLayer layer_of(std::shared_ptr<const RenderList> list, bool in_front) {
  return {std::move(list), in_front, camera_at({0, 0, 10}), {}};
}

}  // namespace

TEST_CASE("draws layers from back to front, each in its part of the picture (X3D 35.4.4)") {
  Drawing drawing;
  RenderList active = *filled({1, 0, 0}, {0, 0.5, 0, 1});
  active.layers.push_back(layer_of(filled({0, 0, 1}, {0, 1, 0, 1}), false));
  active.layers.push_back(layer_of(filled({0, 1, 0}, {0.25, 0.75, 0.5, 1}), true));
  const Image image = drawing.draw(active, camera_at({0, 0, 10}));
  CHECK(pixel(image, 4, kSide - 4) == glm::vec3(255, 0, 0));
  CHECK(pixel(image, kSide - 4, kSide - 4) == glm::vec3(0, 0, 255));
  CHECK(pixel(image, 20, 4) == glm::vec3(0, 255, 0));
  CHECK(pixel(image, 44, 4) == glm::vec3(0, 255, 0));
  CHECK(pixel(image, 20, kSide - 4) == glm::vec3(255, 0, 0));
}

TEST_CASE("shows the layers behind a layer, unless a Background is bound in it") {
  Drawing drawing;
  RenderList active = *filled({1, 0, 0}, kWholePicture);
  auto front = filled({0, 1, 0}, kWholePicture, 1);
  active.layers.push_back(layer_of(front, true));
  CHECK(pixel(drawing.draw(active, camera_at({0, 0, 10})), 4, 4) == glm::vec3(255, 0, 0));
  front->has_background = true;
  front->background.sky_colors = {glm::vec3(0, 0, 1)};
  const Image image = drawing.draw(active, camera_at({0, 0, 10}));
  CHECK(pixel(image, 4, 4) == glm::vec3(0, 0, 255));
  CHECK(pixel(image, kSide / 2, kSide / 2) == glm::vec3(0, 255, 0));
}

TEST_CASE("draws a layer that is nearer in its own space behind a layer in front of it") {
  Drawing drawing;
  RenderList active;
  add(active, glowing(square(20), {1, 0, 0}, translation({0, 0, 5})));
  active.layers.push_back(layer_of(filled({0, 1, 0}, kWholePicture), true));
  CHECK(pixel(drawing.draw(active, camera_at({0, 0, 10})), 30, 30) == glm::vec3(0, 255, 0));
}

TEST_CASE("draws only the other layers if the active layer is not drawn (X3D 35.4.2)") {
  Drawing drawing;
  RenderList active = *filled({1, 0, 0}, kWholePicture);
  active.drawn = false;
  CHECK(pixel(drawing.draw(active, camera_at({0, 0, 10})), 30, 30) == glm::vec3(0));
  active.layers.push_back(layer_of(filled({0, 1, 0}, {0, 0.5, 0, 1}), false));
  const Image image = drawing.draw(active, camera_at({0, 0, 10}));
  CHECK(pixel(image, 4, 30) == glm::vec3(0, 255, 0));
  CHECK(pixel(image, 60, 30) == glm::vec3(0));
}

TEST_CASE("draws the tiles of a picture with layers like the whole picture") {
  RenderList active = *filled({1, 0, 0}, {0, 0.75, 0, 1}, 3);
  active.layers.push_back(layer_of(filled({0, 1, 0}, {0.25, 1, 0.25, 0.75}, 2), true));
  active.layers.back().extent = glm::dvec2(6, 6);
  Drawing whole;
  const Image all = whole.draw(active, camera_at({0, 0, 10}));
  Drawing tile;
  tile.options.width = tile.options.height = static_cast<int>(kSide / 2);
  for (const bool right : {false, true})
    for (const bool top : {false, true}) {
      Camera camera = camera_at({0, 0, 10});
      camera.part = {right ? 0.0 : -1.0, top ? 0.0 : -1.0, right ? 1.0 : 0.0, top ? 1.0 : 0.0};
      const Image part = tile.draw(active, camera);
      std::size_t different = 0;
      for (std::uint32_t y = 0; y < kSide / 2; ++y)
        for (std::uint32_t x = 0; x < kSide / 2; ++x)
          different += pixel(part, x, y) != pixel(all, x + (right ? kSide / 2 : 0u), y + (top ? 0u : kSide / 2));
      CHECK(different == 0);
    }
}

}  // namespace gs::render::testing
