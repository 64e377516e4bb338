#include "tests/render/drawing.h"

#include <cmath>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

std::shared_ptr<const Image> picture(std::uint32_t width, std::uint32_t height, std::uint32_t components,
                                     std::vector<std::uint8_t> pixels) {
  return std::make_shared<const Image>(Image{width, height, components, std::move(pixels)});
}

/// Returns a row or grid of plain fields, each too large for filtering to reach its centre.
std::shared_ptr<const Image> fields(std::uint32_t across, std::uint32_t down, std::uint32_t components,
                                    const std::vector<std::uint8_t>& colors) {
  constexpr std::uint32_t kSide = 32;
  std::vector<std::uint8_t> pixels;
  for (std::uint32_t y = 0; y < down * kSide; ++y)
    for (std::uint32_t x = 0; x < across * kSide; ++x)
      for (std::uint32_t c = 0; c < components; ++c)
        pixels.push_back(colors[(y / kSide * across + x / kSide) * components + c]);
  return picture(across * kSide, down * kSide, components, pixels);
}

std::shared_ptr<const Image> plain_picture(std::uint32_t components, std::vector<std::uint8_t> one) {
  std::vector<std::uint8_t> pixels;
  for (int i = 0; i < 16; ++i) pixels.insert(pixels.end(), one.begin(), one.end());
  return picture(4, 4, components, pixels);
}

/// Returns the centre pixel of one square that fills the view, lit head-on by the headlight alone.
glm::vec3 middle(Drawing& drawing, const DrawItem& item) {
  RenderList list;
  list.background.sky_colors = {glm::vec3(0, 0, 1)};
  add(list, item);
  return pixel(drawing.draw(list), 32, 32);
}

}  // namespace

TEST_CASE("draws unlit shapes white or in the colours of their Color node (VRML97 Table 4.5)") {
  Drawing drawing;
  CHECK(middle(drawing, unlit(square(20))) == glm::vec3(255));
  auto colored = square(20);
  for (int i = 0; i < 4; ++i) colored->colors.push_back({0.2f, 0.4f, 0.6f});
  CHECK(middle(drawing, unlit(colored)) == glm::vec3(51, 102, 153));
  DrawItem textured = unlit(colored);
  textured.texture.image = plain_picture(3, {10, 20, 30});
  CHECK(middle(drawing, textured) == glm::vec3(10, 20, 30));
  textured.texture.image = plain_picture(1, {128});
  check_color(middle(drawing, textured), glm::vec3(0.2f, 0.4f, 0.6f) * (128 / 255.0f));
}

TEST_CASE("combines textures and colours to the diffuse colour of VRML97 Table 4.6", "[optimised]") {
  Drawing drawing;
  DrawItem item;
  item.mesh = square(20);
  item.material.diffuse = {0.8f, 0.4f, 0.2f};
  SECTION("no texture") { check_color(middle(drawing, item), {0.8f, 0.4f, 0.2f}); }
  SECTION("Color node replaces") {
    auto colored = square(20);
    for (int i = 0; i < 4; ++i) colored->colors.push_back({0.1f, 0.9f, 0.5f});
    item.mesh = colored;
    check_color(middle(drawing, item), {0.1f, 0.9f, 0.5f});
  }
  SECTION("intensity multiplies") {
    item.texture.image = plain_picture(1, {102});
    check_color(middle(drawing, item), glm::vec3(0.8f, 0.4f, 0.2f) * 0.4f);
  }
  SECTION("RGB replaces") {
    item.texture.image = plain_picture(3, {25, 50, 200});
    check_color(middle(drawing, item), glm::vec3(25, 50, 200) / 255.0f);
  }
  SECTION("transparency blends with what is behind") {
    item.material.transparency = 0.25f;
    check_color(middle(drawing, item), glm::vec3(0.8f, 0.4f, 0.2f) * 0.75f + glm::vec3(0, 0, 0.25f));
  }
  SECTION("RGB texture keeps the transparency of the material") {
    item.material.transparency = 0.5f;
    item.texture.image = plain_picture(3, {200, 100, 0});
    check_color(middle(drawing, item), glm::vec3(100, 50, 127.5f) / 255.0f);
  }
  SECTION("alpha of RGBA replaces it") {
    item.material.transparency = 0.9f;
    item.texture.image = plain_picture(4, {200, 100, 0, 51});
    check_color(middle(drawing, item), glm::vec3(40, 20, 204) / 255.0f);
    item.texture.image = plain_picture(4, {200, 100, 0, 255});
    check_color(middle(drawing, item), glm::vec3(200, 100, 0) / 255.0f);
    item.texture.image = plain_picture(4, {200, 100, 0, 0});
    check_color(middle(drawing, item), glm::vec3(0, 0, 1));
  }
  SECTION("intensity with alpha multiplies and replaces transparency") {
    item.texture.image = plain_picture(2, {128, 102});
    check_color(middle(drawing, item), glm::vec3(0.8f, 0.4f, 0.2f) * (128 / 255.0f) * 0.4f + glm::vec3(0, 0, 0.6f));
  }
}

TEST_CASE("puts the first row of an image at the top of its texture, with s to the right") {
  Drawing drawing;
  DrawItem item = unlit(square(4.1421356f));  // exactly as large as the view
  item.texture.image = fields(2, 2, 3, {255, 0, 0, /**/ 0, 255, 0, /**/ 0, 0, 255, /**/ 255, 255, 0});
  RenderList list;
  add(list, item);
  const Image image = drawing.draw(list);
  check_color(pixel(image, 8, 8), {1, 0, 0});
  check_color(pixel(image, 56, 8), {0, 1, 0});
  check_color(pixel(image, 8, 56), {0, 0, 1});
  check_color(pixel(image, 56, 56), {1, 1, 0});
}

TEST_CASE("applies texture transforms and repeat flags") {
  Drawing drawing;
  DrawItem item = unlit(square(4.1421356f));
  item.texture.image = fields(2, 1, 3, {255, 0, 0, 0, 0, 255});
  item.texture.transform[0][0] = 2;  // s runs twice as fast, so the image repeats
  RenderList list;
  add(list, item);
  Image image = drawing.draw(list);
  check_color(pixel(image, 7, 32), {1, 0, 0}, 4);
  check_color(pixel(image, 24, 32), {0, 0, 1}, 4);
  check_color(pixel(image, 39, 32), {1, 0, 0}, 4);
  list.items[0].texture.repeat_s = false;
  image = drawing.draw(list);
  check_color(pixel(image, 7, 32), {1, 0, 0}, 4);
  check_color(pixel(image, 39, 32), {0, 0, 1}, 4);
  check_color(pixel(image, 60, 32), {0, 0, 1}, 4);
}

TEST_CASE("ignores a malformed image") {
  Drawing drawing;
  DrawItem item = unlit(square(20));
  item.texture.image = picture(100, 100, 3, {1, 2, 3});
  CHECK(middle(drawing, item) == glm::vec3(255));
}

TEST_CASE("hides the farther of two shapes in any order of drawing") {
  Drawing drawing;
  for (const bool near_first : {true, false}) {
    RenderList list;
    const DrawItem near_item = glowing(square(20), {1, 0, 0}, translation({0, 0, 1}));
    const DrawItem far_item = glowing(square(20), {0, 1, 0}, translation({0, 0, -1}));
    add(list, near_first ? near_item : far_item);
    add(list, near_first ? far_item : near_item);
    check_color(pixel(drawing.draw(list), 32, 32), {1, 0, 0});
  }
}

TEST_CASE("blends transparent shapes from back to front, whatever the order of the list is") {
  Drawing drawing;
  DrawItem red = glowing(square(20), {1, 0, 0}, translation({0, 0, 1}));
  red.material.transparency = 0.5f;
  DrawItem green = glowing(square(20), {0, 1, 0}, translation({0, 0, 0}));
  green.material.transparency = 0.5f;
  const DrawItem blue = glowing(square(20), {0, 0, 1}, translation({0, 0, -1}));
  const DrawItem hidden = glowing(square(20), {1, 1, 1}, translation({0, 0, -2}));
  for (int order = 0; order < 3; ++order) {
    RenderList list;
    DrawItem items[] = {red, green, blue, hidden};
    for (int i = 0; i < 4; ++i) add(list, items[(i * 3 + order) % 4]);
    check_color(pixel(drawing.draw(list), 32, 32), {0.5f, 0.25f, 0.25f});
  }
}

TEST_CASE("cuts holes by textures of only opaque and invisible pixels, and writes their depth") {
  Drawing drawing;
  DrawItem leaf = unlit(square(4.1421356f), translation({0, 0, 0}));
  leaf.texture.image = fields(2, 1, 4, {255, 0, 0, 255, 0, 0, 0, 0});
  const DrawItem wall = glowing(square(20), {0, 0, 1}, translation({0, 0, -1}));
  RenderList list;
  add(list, leaf);
  add(list, wall);
  const Image image = drawing.draw(list);
  check_color(pixel(image, 14, 32), {1, 0, 0});
  check_color(pixel(image, 50, 32), {0, 0, 1});
}

TEST_CASE("culls back faces of solid shapes, also under a mirroring transformation") {
  Drawing drawing;
  const auto seen = [&](bool solid, const glm::mat4& world_from_node) {
    auto mesh = square(20);
    mesh->solid = solid;
    return middle(drawing, glowing(mesh, {1, 0, 0}, world_from_node)) == glm::vec3(255, 0, 0);
  };
  const glm::mat4 turned = scale({-1, 1, -1});  // half a turn about Y
  CHECK(seen(true, glm::mat4(1.0f)));
  CHECK_FALSE(seen(true, turned));
  CHECK(seen(false, turned));
  CHECK(seen(true, scale({-1, 1, 1})));        // a mirror keeps the front
  CHECK_FALSE(seen(true, scale({1, 1, -1})));  // and the back
  CHECK(seen(false, scale({1, 1, -1})));
}

TEST_CASE("draws instances like single items, in few calls") {
  Drawing drawing;
  const auto fill = [](RenderList& list, bool shared) {
    auto common = square(0.3f);
    for (int i = 0; i < 64; ++i) {
      DrawItem item;
      item.mesh = shared ? common : square(0.3f);
      item.world_from_node = translation({i % 8 - 3.5f, i / 8 - 3.5f, 0});
      item.material.diffuse = {(i % 8) / 7.0f, (i / 8) / 7.0f, 0.5f};
      add(list, item);
    }
  };
  RenderList shared, single;
  fill(shared, true);
  fill(single, false);
  const Image a = drawing.draw(shared);
  CHECK(drawing.statistics.items == 64);
  CHECK(drawing.statistics.triangles == 128);
  CHECK(drawing.statistics.draw_calls == 1);
  const Image b = drawing.draw(single);
  CHECK(drawing.statistics.draw_calls <= 64);  // 1 if the driver draws several meshes in a call
  CHECK(a.pixels == b.pixels);
  for (int i = 0; i < 64; i += 5) {
    const float x = (i % 8 - 3.5f) / 4.1421356f, y = (i / 8 - 3.5f) / 4.1421356f;
    check_color(pixel(a, static_cast<std::uint32_t>((x + 1) * 32), static_cast<std::uint32_t>((1 - y) * 32)),
                shared.items[static_cast<std::size_t>(i)].material.diffuse);
  }
}

TEST_CASE("draws twenty thousand shapes of four meshes and eight materials in at most four calls") {
  Drawing drawing;
  std::shared_ptr<const vrml::Mesh> meshes[] = {square(0.1f), square(0.2f), square(0.3f), square(0.4f)};
  RenderList list;
  for (int i = 0; i < 20000; ++i) {
    DrawItem item;
    item.mesh = meshes[i % 4];
    item.material.diffuse = glm::vec3((i % 8) / 8.0f);
    item.world_from_node = translation({i % 100 - 50.0f, i / 100 % 100 - 50.0f, i / 10000 * -1.0f});
    add(list, item);
  }
  (void)drawing.draw(list, camera_at({0, 0, 150}));
  CHECK(drawing.statistics.items == 20000);
  CHECK(drawing.statistics.draw_calls <= 4);  // 1 if the driver draws several meshes in a call
}

TEST_CASE("draws the same picture at survey coordinates far from the origin") {
  Drawing drawing;
  const auto draw = [&](const glm::vec3& offset) {
    RenderList list;
    DrawItem item;
    item.mesh = square(1);
    item.material.diffuse = {0.7f, 0.6f, 0.5f};
    item.material.specular = glm::vec3(0.3f);
    item.world_from_node = translation(offset);
    add(list, item);
    item.world_from_node = translation(offset + glm::vec3(2.5f, 0.5f, -1));
    add(list, item);
    Light light;
    light.kind = Light::Kind::point;
    light.location = offset + glm::vec3(0, 1, 2);
    light.attenuation = {0, 0.5f, 0};
    list.lights.push_back(light);
    return drawing.draw(list, camera_at(offset + glm::vec3(0, 0, 10)));
  };
  const Image here = draw(glm::vec3(0)), there = draw({3e6f, 5e6f, 1024});  // float32 steps there: 0.25 and 0.5
  CHECK(here.pixels == there.pixels);
  check_color(pixel(here, 1, 1), glm::vec3(0));
}

TEST_CASE("measures visibilityLimit in metres of the bound Viewpoint (6.29)") {
  Drawing drawing;
  RenderList list;
  add(list, glowing(square(4), {0, 1, 0}));
  list.navigation.visibility_limit = 6;  // the square is 10 away
  check_color(pixel(drawing.draw(list), 32, 32), {0, 0, 0});
  drawing.options.unit = 2;
  check_color(pixel(drawing.draw(list), 32, 32), {0, 1, 0});
}

TEST_CASE("draws lines and points unlit in emissive or Color node colours") {
  Drawing drawing;
  auto lines = std::make_shared<vrml::Mesh>();
  lines->primitive = vrml::Mesh::Primitive::lines;
  lines->lit = false;
  lines->positions = {{-20, 0.065f, 0}, {20, 0.065f, 0}};  // through the middle of a row of pixels
  lines->indices = {0, 1};
  lines->bounds.add(lines->positions[0]);
  lines->bounds.add(lines->positions[1]);
  DrawItem item;
  item.mesh = lines;
  item.material.emissive = {0, 1, 0};
  RenderList list;
  add(list, item);
  check_color(pixel(drawing.draw(list), 20, 31), {0, 1, 0});
  list.items[0].material.lit = false;
  list.items[0].material.diffuse = glm::vec3(1);
  check_color(pixel(drawing.draw(list), 20, 31), {1, 1, 1});
  CHECK(drawing.statistics.triangles == 0);

  auto points = std::make_shared<vrml::Mesh>();
  points->primitive = vrml::Mesh::Primitive::points;
  points->lit = false;
  points->positions = {{0, 0, 0}};
  points->colors = {{1, 0, 1}};
  points->indices = {0};
  points->bounds.add(points->positions[0]);
  list.items[0].mesh = points;
  const Image image = drawing.draw(list);
  check_color(pixel(image, 31, 31), {1, 0, 1});
  check_color(pixel(image, 32, 32), {1, 0, 1});
  check_color(pixel(image, 34, 32), {0, 0, 0});
}

TEST_CASE("skips broken meshes") {
  Drawing drawing;
  RenderList list;
  auto out_of_range = square(20);
  out_of_range->indices = {0, 1, 99};
  add(list, unlit(out_of_range));
  auto half_normals = square(20);
  half_normals->normals = {{0, 0, 1}};
  DrawItem item;
  item.mesh = half_normals;
  item.material.diffuse = glm::vec3(0.5f);
  add(list, item);
  add(list, unlit(std::make_shared<vrml::Mesh>()));
  list.items.push_back({});
  DrawItem infinite = unlit(square(20));
  infinite.world_from_node[3][2] = HUGE_VALF;
  list.items.push_back(infinite);
  check_color(pixel(drawing.draw(list), 32, 32), glm::vec3(0.5f));
  CHECK(drawing.statistics.items == 1);
}

TEST_CASE("uploads a mesh or an image again that reuses the address of a freed one") {
  Drawing drawing;
  for (int i = 0; i < 30; ++i) {
    auto mesh = square(20);
    for (int k = 0; k < 4; ++k) mesh->colors.push_back({i / 30.0f, 0.5f, 0});
    DrawItem item = unlit(mesh);
    check_color(middle(drawing, item), {i / 30.0f, 0.5f, 0});
    item.texture.image = plain_picture(3, {static_cast<std::uint8_t>(i), 7, 9});
    check_color(middle(drawing, item), glm::vec3(i, 7, 9) / 255.0f);
  }
}

TEST_CASE("checks size limits and samples of pictures, and draws one background colour") {
  Drawing drawing;
  RenderList list;
  drawing.options.background = glm::vec3(0.2f, 0.4f, 0.6f);
  drawing.options.width = 37;
  drawing.options.height = 5;
  drawing.options.samples = 64;  // lowered to the maximum
  const Image image = drawing.draw(list);
  CHECK(image.width == 37);
  CHECK(image.height == 5);
  CHECK(image.components == 3);
  CHECK(pixel(image, 36, 4) == glm::vec3(51, 102, 153));
  drawing.options.width = 1 << 20;
  const auto refused = drawing.renderer().draw_to_image(list, {}, drawing.options);
  REQUIRE(std::holds_alternative<ContextError>(refused));
  CHECK(std::get<ContextError>(refused).message.find("1048576x5") != std::string::npos);
  CHECK_FALSE(drawing.renderer().gl_renderer().empty());
}

TEST_CASE("smooths edges by multisampling") {
  Drawing drawing;
  RenderList list;
  DrawItem item = unlit(square(1));
  item.world_from_node[0][1] = 0.3f;  // slanted
  add(list, item);
  const auto grays = [&](int samples) {
    drawing.options.samples = samples;
    const Image image = drawing.draw(list);
    int count = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += 3) count += image.pixels[i] != 0 && image.pixels[i] != 255;
    return count;
  };
  CHECK(grays(1) == 0);
  CHECK(grays(4) > 10);
}
