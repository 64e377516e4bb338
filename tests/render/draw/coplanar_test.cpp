// Tests of coplanar faces and of minified textures. Both must be free of patterns.
#include "render/gl/texture_store.h"
#include "tests/render/drawing.h"

#include <glm/gtc/matrix_transform.hpp>

#include <cstdint>
#include <utility>

namespace gs::render::testing {
namespace {

TEST_CASE("shows the last of several coplanar faces without artefacts") {
  Drawing drawing;
  for (const float angle : {0.0f, 0.4f, 1.1f, -1.3f}) {
    glm::mat4 slanted = glm::rotate(translation({0.3f, 0, 0}), angle, glm::normalize(glm::vec3(0.3f, 1, 0.2f)));
    slanted = glm::scale(slanted, glm::vec3(3, 2, 1));
    // Different programs draw them: lit, unlit and textured.
    DrawItem lit = glowing(square(), {1, 0, 0}, slanted), plain = unlit(square(), slanted),
             textured = unlit(square(), slanted);
    textured.texture.image = std::make_shared<const Image>(Image{1, 1, 3, {0, 255, 0}});
    const std::pair<DrawItem, glm::vec3> items[] = {{lit, {1, 0, 0}}, {plain, {1, 1, 1}}, {textured, {0, 1, 0}}};
    for (const auto& below : items)
      for (const auto& above : items) {
        RenderList list;
        for (const auto& third : items)
          if (third.second != above.second) add(list, third.first);
        add(list, below.first);
        add(list, above.first);
        const Image image = drawing.draw(list);
        std::size_t shown = 0, others = 0;
        for (std::uint32_t y = 0; y < image.height; ++y)
          for (std::uint32_t x = 0; x < image.width; ++x) {
            const glm::vec3 color = pixel(image, x, y);
            shown += color == above.second * 255.0f;
            others += color != above.second * 255.0f && color != glm::vec3(0);
          }
        CHECK(shown > 50);
        CHECK(others == 0);
      }
  }
}

TEST_CASE("shows the last of several coplanar faces of one mesh") {
  Drawing drawing;
  auto mesh = square();
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  for (std::uint32_t i = 0; i < first; ++i) {
    mesh->positions.push_back(glm::vec3(mesh->positions[i]));
    mesh->normals.push_back({0, 0, 1});
    mesh->texture_coordinates.push_back({0, 0});
  }
  for (std::uint32_t i = 0; i < 2 * first; ++i)
    mesh->colors.push_back(i < first ? vrml::Color{1, 0, 0} : vrml::Color{0, 0, 1});
  for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 3u}) mesh->indices.push_back(first + corner);
  RenderList list;
  add(list, unlit(mesh, glm::rotate(glm::mat4(1), 0.9f, glm::normalize(glm::vec3(1, 2, 0)))));
  const Image image = drawing.draw(list);
  std::size_t red = 0, blue = 0;
  for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
    red += image.pixels[i] != 0;
    blue += image.pixels[i + 2] != 0;
  }
  CHECK(red == 0);
  CHECK(blue > 20);
}

TEST_CASE("draws lines and points completely on faces and along their edges") {
  Drawing drawing;
  drawing.options.width = drawing.options.height = 128;
  auto line = std::make_shared<vrml::Mesh>(), point = std::make_shared<vrml::Mesh>();
  line->primitive = vrml::Mesh::Primitive::lines;
  line->lit = point->lit = false;
  point->primitive = vrml::Mesh::Primitive::points;
  // The lines are a diagonal, an edge and a line across; the points are the corners of the last face.
  line->positions = {{-1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {1, 1, 0}, {-0.9f, 0.3f, 0}, {0.8f, -0.7f, 0}};
  point->positions = {line->positions[4], line->positions[5]};
  line->indices = {0, 1, 2, 3, 4, 5};
  point->indices = {0, 1};
  for (const glm::vec3& p : line->positions) line->bounds.add(p), point->bounds.add(p);
  for (const float angle : {0.0f, 0.4f, 0.9f, 1.1f, -1.2f}) {
    glm::mat4 slanted = glm::rotate(translation({0.3f, 0, 0}), angle, glm::normalize(glm::vec3(0.3f, 1, 0.2f)));
    slanted = glm::scale(slanted, glm::vec3(3, 2.3f, 1));
    for (const auto& marks : {line, point}) {
      RenderList alone, both;
      add(alone, unlit(marks, slanted));
      add(both, unlit(marks, slanted));
      add(both, glowing(square(), {1, 0, 0}, slanted));
      // A face hidden by a nearer face stays hidden.
      add(both, glowing(square(), {0, 0, 1}, glm::translate(slanted, {0, 0, -0.05f})));
      const Image wanted = drawing.draw(alone), image = drawing.draw(both);
      std::size_t marked = 0, hidden = 0;
      for (std::uint32_t y = 0; y < image.height; ++y)
        for (std::uint32_t x = 0; x < image.width; ++x) {
          if (pixel(wanted, x, y) == glm::vec3(0)) continue;
          ++marked;
          hidden += pixel(image, x, y) != pixel(wanted, x, y);
        }
      INFO("angle " << angle << ", " << marked << " pixels");
      CHECK(marked > (marks == line ? 100 : 1));
      CHECK(hidden == 0);
    }
  }
}

TEST_CASE("draws a fine checker on a slanted plane in its mean grey, without moire") {
  // 128 x 128 cells on a receding plane, up to about twenty per pixel.
  constexpr std::uint32_t kCells = 128;
  Image checker{kCells, kCells, 3, {}};
  for (std::uint32_t i = 0; i < kCells * kCells; ++i)
    checker.pixels.insert(checker.pixels.end(), 3, (i + i / kCells) % 2 == 0 ? 255 : 0);
  constexpr float kRepeats = 8, kHalf = 40;
  DrawItem item = unlit(square(kHalf), glm::rotate(translation({0, -2, -kHalf}), -1.5707963f, {1, 0, 0}));
  item.texture.image = std::make_shared<const Image>(std::move(checker));
  item.texture.transform[0][0] = item.texture.transform[1][1] = kRepeats;
  RenderList list;
  add(list, item);
  for (const int samples : {1, 4}) {
    Drawing drawing;
    drawing.options.width = drawing.options.height = 128;
    drawing.options.samples = samples;
    const Image image = drawing.draw(list, camera_at({0, 0, 0}));
    // A cell is kHalf * 2 / (kRepeats * kCells) m wide; row y below the horizon is 2 / slope away.
    const float cell = kHalf * 2 / (kRepeats * kCells), pixel_angle = 2 * std::tan(0.785398f / 2) / 128;
    std::size_t looked_at = 0;
    double worst = 0, sum = 0;
    for (std::uint32_t y = 65; y < 128; ++y) {
      const float slope = (static_cast<float>(y) + 0.5f - 64) * pixel_angle, distance = 2 / slope;
      const float wide = distance * pixel_angle / cell;  // cells across a pixel
      // A pixel of two cells or more is grey on average, except at the edges of the square.
      if (wide < 2 || distance > 2 * kHalf - 2) continue;
      for (std::uint32_t x = 32; x < 96; ++x) {
        const double off = std::abs(pixel(image, x, y).x - 127.5);
        worst = std::max(worst, off);
        sum += off;
        ++looked_at;
      }
    }
    INFO("samples " << samples << ", pixels " << looked_at << ", mean " << sum / static_cast<double>(looked_at));
    REQUIRE(looked_at > 500);
    // The error of a box filter over `wide` cells is at most half a cell.
    CHECK(worst <= 255.0 / 8);
    CHECK(sum / static_cast<double>(looked_at) < 8);
  }
}

TEST_CASE("filters textures anisotropically where the driver can") {
  Drawing drawing;
  auto loaded = Gl::load(drawing.context());
  REQUIRE(std::holds_alternative<Gl>(loaded));
  const Gl& gl = std::get<Gl>(loaded);
  if (gl.software) CHECK(gl.max_anisotropy == 1);  // see the next case
  if (gl.max_anisotropy <= 1) return;              // the driver has no GL_EXT_texture_filter_anisotropic
  TextureStore store(gl);
  const auto image = std::make_shared<const Image>(Image{2, 2, 3, std::vector<std::uint8_t>(12, 255)});
  const TextureStore::Entry* entry = store.find(image);
  REQUIRE(entry);
  store.bind(*entry, true, true);
  GLint sampler = 0;
  constexpr GLenum kSamplerBinding = 0x8919;
  gl.GetIntegerv(kSamplerBinding, &sampler);
  CHECK(sampler != 0);
  const auto get =
      reinterpret_cast<PFNGLGETSAMPLERPARAMETERFVPROC>(drawing.context().proc_address("glGetSamplerParameterfv"));
  REQUIRE(get);
  float anisotropy = 0;
  constexpr GLenum kTextureMaxAnisotropy = 0x84FE;
  get(static_cast<GLuint>(sampler), kTextureMaxAnisotropy, &anisotropy);
  CHECK(anisotropy >= std::min(gl.max_anisotropy, 4.0f));
}

// llvmpipe's anisotropic filter reads all texels of a pixel, which would take hours.
TEST_CASE("draws the mean of a texture that repeats a million times on a slanted plane") {
  Image checker{2, 2, 3, {}};
  for (const std::uint8_t value : {255, 0, 0, 255}) checker.pixels.insert(checker.pixels.end(), 3, value);
  DrawItem item = unlit(square(20), glm::rotate(translation({0, -2, -20}), -1.5707963f, {1, 0, 0}));
  item.texture.image = std::make_shared<const Image>(std::move(checker));
  item.texture.transform[0][0] = item.texture.transform[1][1] = 1e6f;
  RenderList list;
  add(list, item);
  Drawing drawing;
  const Image image = drawing.draw(list, camera_at({0, 0, 0}));
  for (std::uint32_t x = 16; x < 48; ++x) CHECK(std::abs(pixel(image, x, 56).x - 127.5) <= 2);
}

TEST_CASE("keeps the width of lines and points in multisampled pictures") {
  Drawing drawing;
  auto lines = std::make_shared<vrml::Mesh>();
  lines->primitive = vrml::Mesh::Primitive::lines;
  lines->lit = false;
  lines->positions = {{-20, 0.3f, 0}, {20, 0.3f, 0}};
  lines->indices = {0, 1};
  for (const glm::vec3& p : lines->positions) lines->bounds.add(p);
  auto points = std::make_shared<vrml::Mesh>(*lines);
  points->primitive = vrml::Mesh::Primitive::points;
  points->positions = {{0, -1, 0}};
  points->indices = {0};
  const auto light = [&](const std::shared_ptr<vrml::Mesh>& mesh, int samples) {
    drawing.options.samples = samples;
    RenderList list;
    add(list, unlit(mesh));
    const Image image = drawing.draw(list);
    double sum = 0;
    for (const std::uint8_t value : image.pixels) sum += value / 765.0;
    return sum;
  };
  CHECK(light(lines, 1) == Approx(64).margin(1));
  CHECK(light(lines, 4) == Approx(64).margin(1));
  CHECK(light(points, 1) == Approx(4).margin(0.1));
  CHECK(light(points, 4) == Approx(4).margin(0.1));
}

TEST_CASE("draws the same picture after preparation") {
  RenderList list;
  add(list, glowing(square(), {0, 0.5f, 1}));
  for (const int samples : {1, 4}) {
    Drawing fresh, ready;
    fresh.options.samples = ready.options.samples = samples;
    ready.renderer().prepare(ready.options);
    CHECK(fresh.draw(list).pixels == ready.draw(list).pixels);
    CHECK(ready.draw(RenderList()).pixels == std::vector<std::uint8_t>(std::size_t{64} * 64 * 3, 0));
  }
}

}  // namespace
}  // namespace gs::render::testing
