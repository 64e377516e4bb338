#include "app/encode/textured_surface.h"

#include "render/scene/render_list.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "tests/render/image_difference.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app::textured_surface_test {
namespace {

using render::Image;

/// Returns an image with a smooth wave of brightness in one colour.
std::shared_ptr<Image> wave(std::uint32_t size, const glm::vec3& color, std::uint32_t components = 3) {
  auto image = std::make_shared<Image>();
  image->width = image->height = size;
  image->components = components;
  for (std::uint32_t y = 0; y < size; ++y)
    for (std::uint32_t x = 0; x < size; ++x) {
      const float at = 0.5f + 0.4f * std::sin(6.28f * static_cast<float>(x) / static_cast<float>(size)) *
                                  std::cos(6.28f * static_cast<float>(y) / static_cast<float>(size));
      for (std::uint32_t k = 0; k < components; ++k)
        image->pixels.push_back(k == 3 || (k == 1 && components == 2)
                                    ? 255
                                    : static_cast<std::uint8_t>(255 * at * color[static_cast<int>(k)]));
    }
  return image;
}

/// Adds a square of two triangles at a height, with texture coordinates from `lower` to `upper`.
render::DrawItem& add_square(render::RenderList& list, float z, std::shared_ptr<const Image> image,
                             const glm::vec2& lower = glm::vec2(0), const glm::vec2& upper = glm::vec2(1)) {
  const std::vector<glm::vec3> positions{{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}}, normals(4, glm::vec3(0, 0, 1));
  const std::vector<glm::vec2> at{lower, {upper.x, lower.y}, upper, {lower.x, upper.y}};
  const std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
  auto mesh = std::make_shared<vrml::Mesh>();
  mesh->positions = Array<glm::vec3>(std::span<const glm::vec3>(positions));
  mesh->normals = Array<glm::vec3>(std::span<const glm::vec3>(normals));
  if (image) mesh->texture_coordinates = Array<glm::vec2>(std::span<const glm::vec2>(at));
  mesh->indices = Array<std::uint32_t>(std::span<const std::uint32_t>(indices));
  render::DrawItem& item = list.items.emplace_back();
  item.mesh = std::move(mesh);
  item.texture.image = std::move(image);
  return item;
}

Image decoded(const qnv::TexturedSurface& surface) {
  auto image = render::decode_image(surface.picture.back().bytes);
  REQUIRE(std::holds_alternative<Image>(image));
  return std::get<Image>(std::move(image));
}
/// Returns the texel at s and t without filtering.
glm::vec3 color_at(const Image& image, glm::vec2 at, bool repeat) {
  at = repeat ? at - glm::floor(at) : glm::clamp(at, 0.0f, 1.0f);
  const auto x = std::min(static_cast<std::uint32_t>(at.x * static_cast<float>(image.width)), image.width - 1);
  const auto y = std::min(static_cast<std::uint32_t>((1 - at.y) * static_cast<float>(image.height)), image.height - 1);
  const std::uint8_t* c = image.pixels.data() + (std::size_t{y} * image.width + x) * image.components;
  return image.components < 3 ? glm::vec3(c[0]) : glm::vec3(c[0], c[1], c[2]);
}
/// Returns the colour of a triangle at a point, given by the weights of its corners.
glm::vec3 shown(const qnv::TexturedSurface& surface, const Image& image, std::size_t t, const glm::vec3& weights) {
  const auto& at = surface.coordinates[t];
  return color_at(image, at[0] * weights.x + at[1] * weights.y + at[2] * weights.z, surface.repeat_s);
}
const std::vector<glm::vec3> kPlaces{{0.6f, 0.2f, 0.2f}, {0.2f, 0.6f, 0.2f}, {0.1f, 0.3f, 0.6f}, {0.34f, 0.33f, 0.33f}};

}  // namespace

TEST_CASE("keeps a single texture and its coordinates unchanged") {
  render::RenderList list;
  const auto image = wave(256, {1, 0.5f, 0.2f});
  render::DrawItem& item = add_square(list, 0, image, {-1, 0}, {2, 1.5f});
  item.texture.repeat_t = false;
  const auto surface = textured_surface(list, glm::dvec3(5, 0, 0));
  REQUIRE(surface);
  CHECK(surface->triangles.size() == 2);
  CHECK(surface->triangles[0].positions[0] == glm::vec3(-5, 0, 0));
  CHECK(surface->coordinates[0][0] == glm::vec2(-1, 0));
  CHECK(surface->coordinates[0][2] == glm::vec2(2, 1.5f));
  CHECK(surface->repeat_s);
  CHECK(!surface->repeat_t);
  CHECK(surface->width == 256);
  const Image back = decoded(*surface);
  const auto off = render::compare(back, *image);
  REQUIRE(std::holds_alternative<render::ImageDifference>(off));
  CHECK(std::get<render::ImageDifference>(off).psnr > 38);
  // A coarse file precedes the full one, and the sufficient part of each decodes.
  REQUIRE(surface->picture.size() == 2);
  CHECK(surface->picture[0].bytes.size() < surface->picture[1].bytes.size() / 2);
  for (const qnv::PictureFile& file : surface->picture) {
    REQUIRE(file.enough <= file.bytes.size());
    CHECK(std::holds_alternative<Image>(render::decode_image(std::span(file.bytes).first(file.enough))));
  }
}

TEST_CASE("applies a texture transform to the coordinates") {
  render::RenderList list;
  render::DrawItem& item = add_square(list, 0, wave(64, glm::vec3(1)));
  item.texture.transform = glm::mat3(2, 0, 0, 0, 3, 0, 0.5f, 0.25f, 1);
  const auto surface = textured_surface(list, glm::dvec3(0));
  REQUIRE(surface);
  CHECK(surface->coordinates[0][2] == glm::vec2(2.5f, 3.25f));
}

TEST_CASE("arranges several textures, and colours without one, side by side in one texture") {
  render::RenderList list;
  const auto red = wave(64, {1, 0.1f, 0.1f}), green = wave(96, {0.1f, 1, 0.1f}), grey = wave(32, glm::vec3(1), 1);
  add_square(list, 0, red);
  add_square(list, 1, green, {3.25f, -2}, {5.25f, -1});  // repeated, and shifted
  add_square(list, 2, nullptr).material.diffuse = {0.2f, 0.3f, 0.9f};
  add_square(list, 3, grey).material.diffuse = {0.5f, 1, 0.5f};
  add_square(list, 4, red);
  const auto surface = textured_surface(list, glm::dvec3(0), 95);
  REQUIRE(surface);
  REQUIRE(surface->triangles.size() == 10);
  CHECK(!surface->repeat_s);
  const Image all = decoded(*surface);
  CHECK(all.width == surface->width);
  for (const auto& corners : surface->coordinates)
    for (const glm::vec2& at : corners) {
      CHECK(glm::all(glm::greaterThan(at, glm::vec2(0))));
      CHECK(glm::all(glm::lessThan(at, glm::vec2(1))));
    }
  for (std::size_t t = 0; t < 10; ++t)
    for (const glm::vec3& w : kPlaces) {
      const bool second = t % 2 == 1;
      const glm::vec2 in_square = second ? glm::vec2(w.y, w.y + w.z) : glm::vec2(w.y + w.z, w.z);
      glm::vec3 wanted;
      switch (t / 2) {
        case 0:
        case 4:
          wanted = color_at(*red, in_square, true);
          break;
        case 1:
          wanted = color_at(*green, glm::vec2(3.25f, -2) + in_square * glm::vec2(2, 1), true);
          break;
        case 2:
          wanted = glm::vec3(0.2f, 0.3f, 0.9f) * 255.0f;
          break;
        default:
          wanted = color_at(*grey, in_square, true) * glm::vec3(0.5f, 1, 0.5f);
          break;
      }
      INFO("triangle " << t << " at " << w.x << " " << w.y);
      const glm::vec3 is = shown(*surface, all, t, w);
      CHECK(glm::length(is - wanted) < 30);  // shifted by a pixel, after JPEG
    }
}

TEST_CASE("makes no texture if one cannot represent all") {
  const auto red = wave(64, {1, 0.1f, 0.1f});
  render::RenderList list;
  CHECK(!textured_surface(list, glm::dvec3(0)));
  add_square(list, 0, nullptr);
  CHECK(!textured_surface(list, glm::dvec3(0)));  // no texture
  {
    render::RenderList seen_through = list;
    auto glass = wave(16, glm::vec3(1), 4);
    add_square(seen_through, 1, glass);
    CHECK(textured_surface(seen_through, glm::dvec3(0)));
    glass->pixels[7] = 100;
    CHECK(!textured_surface(seen_through, glm::dvec3(0)));
  }
  {
    render::RenderList often = list;
    add_square(often, 1, red, {0, 0}, {40, 40});
    CHECK(!textured_surface(often, glm::dvec3(0)));
  }
  {
    render::RenderList painted = list;
    add_square(painted, 1, red);
    render::DrawItem& item = add_square(painted, 2, nullptr);
    auto mesh = std::make_shared<vrml::Mesh>(*item.mesh);
    const std::vector<vrml::Color> colors{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    mesh->colors = Array<vrml::Color>(std::span<const vrml::Color>(colors));
    item.mesh = mesh;
    CHECK(!textured_surface(painted, glm::dvec3(0)));
  }
}

TEST_CASE("writes a texture of few colours as a lossless PNG") {
  auto image = std::make_shared<Image>();
  image->width = image->height = 256;
  image->components = 3;
  for (std::uint32_t y = 0; y < 256; ++y)
    for (std::uint32_t x = 0; x < 256; ++x) {
      const bool on = (x / 5 + y / 7) % 2 == 0;
      image->pixels.insert(image->pixels.end(),
                           {static_cast<std::uint8_t>(on ? 255 : 10), 20, static_cast<std::uint8_t>(on ? 0 : 90)});
    }
  render::RenderList list;
  add_square(list, 0, image);
  const auto surface = textured_surface(list, glm::dvec3(0));
  REQUIRE(surface);
  CHECK(decoded(*surface).pixels == image->pixels);
  CHECK(surface->picture.back().enough == surface->picture.back().bytes.size());
}

}  // namespace gs::app::textured_surface_test
