#include "render/gl/gl.h"
#include "render/mesh/filled_spheres.h"
#include "tests/render/drawing.h"

#include <catch2/catch.hpp>

#include <cstddef>
#include <memory>
#include <variant>

namespace gs::many_meshes_test {
namespace {

using namespace render;
using namespace render::testing;

glm::vec3 color_of(int column, int row) {
  return {0.1f + 0.1f * static_cast<float>(column % 8), 0.1f + 0.1f * static_cast<float>(row % 8),
          static_cast<float>((column + row) % 2)};
}

/// Returns squares in 16 x 16 places, with an own mesh and colour each.
RenderList many_meshes(float transparency) {
  RenderList list;
  for (int row = 0; row < 16; ++row)
    for (int column = 0; column < 16; ++column) {
      DrawItem item = glowing(square(0.45f), color_of(column, row),
                              translation({static_cast<float>(column) - 7.5f, static_cast<float>(row) - 7.5f, 0}));
      item.material.transparency = transparency;
      add(list, std::move(item));
    }
  return list;
}

void check_squares(const Image& image, float opacity) {
  for (std::uint32_t row = 0; row < 16; ++row)
    for (std::uint32_t column = 0; column < 16; ++column) {
      INFO("row " << row << ", column " << column);
      check_color(pixel(image, 16 * column + 8, 255 - (16 * row + 8)),
                  opacity * color_of(static_cast<int>(column), static_cast<int>(row)), 2);
    }
}

}  // namespace

TEST_CASE("draws many different meshes with one call, each with its own matrix and colour") {
  Drawing drawing;
  drawing.options.width = drawing.options.height = 256;
  auto loaded = Gl::load(drawing.context());
  REQUIRE(std::holds_alternative<Gl>(loaded));
  Camera camera = camera_at({0, 0, 10});
  camera.height = 16;
  for (const float transparency : {0.0f, 0.25f}) {
    const RenderList list = many_meshes(transparency);
    check_squares(drawing.draw(list, camera), 1 - transparency);
    CHECK(drawing.statistics.items == 256);
    CHECK(drawing.statistics.triangles == 512);
    // A driver with OpenGL 4.3 needs one call.
    if (std::get<Gl>(loaded).MultiDrawElementsIndirect) CHECK(drawing.statistics.draw_calls == 1);
  }
  // Drawing that can be cancelled draws in small parts.
  drawing.options.go_on = CancellationCheck{[] { return true; }};
  check_squares(drawing.draw(many_meshes(0), camera), 1);
  CHECK(drawing.statistics.triangles == 512);
  drawing.options.width = drawing.options.height = 1024;  // a part has 128 triangles
  int asked = 0;
  drawing.options.go_on = CancellationCheck{[&] { return ++asked < 2; }};
  (void)drawing.draw(many_meshes(0), camera);
  CHECK(drawing.statistics.given_up);
  CHECK(drawing.statistics.triangles < 512);
}

TEST_CASE("gives later layers to later items with equal spheres and other states") {
  FilledSpheres filled;
  const glm::vec3 place(1, 2, 3);
  for (const std::size_t expected : {0u, 1u, 1000u}) {
    filled.begin(expected);
    CHECK(filled.layer_of(place, 1, {1, 1}) == 0);
    CHECK(filled.layer_of(place, 1, {1, 1}) == 0);
    CHECK(filled.layer_of(place, 1, {1, 2}) == 1);
    CHECK(filled.layer_of(place, 1, {1, 1}) == 2);
    CHECK(filled.layer_of(place, 2, {1, 2}) == 0);
    CHECK(filled.layer_of({1, 2, -3}, 1, {1, 2}) == 0);
    for (std::uint64_t i = 3; i < 100; ++i) CHECK(filled.layer_of(place, 1, {1, i}) == std::min<std::uint64_t>(i, 8));
    for (int i = 0; i < 3000; ++i) CHECK(filled.layer_of({i, 0, 0}, 0.5f, {1, 1}) == 0);
    for (int i = 0; i < 3000; ++i) CHECK(filled.layer_of({i, 0, 0}, 0.5f, {2, 1}) == 1);
  }
}

}  // namespace gs::many_meshes_test
