#include "render/volume/volume_pass.h"

#include "tests/render/volume/one_volume.h"
#include "tests/render/volume_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

using namespace gs;
using namespace gs::render;
using namespace gs::test;

namespace {

constexpr int kWidth = 80, kHeight = 60;
using Target = VolumePicture;

/// Returns one pixel in 0..1.
glm::vec3 pixel_color(const Pixels& pixels, int x, int y) {
  const std::uint8_t* p = pixels.data() + 4 * (y * kWidth + x);
  return glm::vec3(p[0], p[1], p[2]) / 255.0f;
}

std::size_t index_of(int x, int y) { return static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x); }

/// Returns a rectangle that faces the camera at `depth` and covers pixels x0..x1, y0..y1 (exclusive) of `target`.
std::array<glm::vec3, 4> rectangle(const Target& target, float depth, float x0, float y0, float x1, float y1) {
  const glm::vec2 t = target.view().tangents;
  const auto corner = [&](float x, float y) {
    return glm::vec3((x / kWidth * 2 - 1) * t.x * depth, (y / kHeight * 2 - 1) * t.y * depth, -depth);
  };
  return {corner(x0, y0), corner(x1, y0), corner(x0, y1), corner(x1, y1)};
}

VolumeItem item_of(const qnv::Volume& geometry, const VolumeModel& model, const glm::mat4& camera_from_node) {
  return {&geometry, &model, camera_from_node, model.spacing.size(), {}};
}

}  // namespace

TEST_CASE("blends a volume over the picture, pixel by pixel") {
  Target target;
  const auto geometry = std::make_shared<const qnv::Volume>(random_volume(900, 5, 0.12f));
  const Pixels drawn = target.draw(volume_list(geometry), {0.2f, 0.4f, 0.8f}, 9);
  CHECK(target.statistics.vectors == 900);
  CHECK(target.statistics.draw_calls == 1);
  SplatView view;
  view.camera_from_node = testing::translation({0, 0, -3});
  view.tangents = projection(target.camera, kWidth, kHeight).tangents();
  view.width = kWidth;
  view.height = kHeight;
  view.near_plane = 0.1f;
  const VolumeLayer layer = test::rasterize_volume(*geometry, view);
  REQUIRE(layer.pixels.size() == drawn.size());
  const std::array<float, 3> under = {0.2f * 255, 0.4f * 255, 0.8f * 255};
  float furthest = 0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (i % 4 == 3) continue;
    const float clear = 1 - layer.pixels[i - i % 4 + 3] / 255.0f;
    furthest = std::max(furthest, std::abs(drawn[i] - (layer.pixels[i] + clear * under[i % 4])));
  }
  CHECK(furthest <= 1.6f);
}

TEST_CASE("hides a volume behind a polygon, and draws it over one behind it") {
  Target target;
  const auto geometry = std::make_shared<const qnv::Volume>(random_volume(900, 5, 0.12f));
  const glm::vec3 color(0, 0, 1);
  CHECK(plain(target.draw(volume_list(geometry), color, 1), color));
  CHECK(!plain(target.draw(volume_list(geometry), color, 5), color));
}

TEST_CASE("ignores surfaces, empty volumes and volumes behind the camera") {
  Target target;
  const glm::vec3 color(0.6f, 0, 0);
  qnv::Splats surface;
  static_cast<qnv::VectorArrays&>(surface) = random_volume(50, 1, 0.1f);
  RenderList splats = volume_list(std::make_shared<const qnv::Volume>());
  splats.splats[0].geometry = std::make_shared<const qnv::Geometry>(surface);
  CHECK(plain(target.draw(splats, color, 9), color));
  CHECK(target.statistics.vectors == 0);
  CHECK(plain(target.draw(volume_list(std::make_shared<const qnv::Volume>()), color, 9), color));
  RenderList list = volume_list(std::make_shared<const qnv::Volume>(random_volume(50, 1, 0.1f)));
  list.splats[0].world_from_node = testing::translation({0, 0, 30});
  CHECK(plain(target.draw(list, color, 9), color));
}

TEST_CASE("applies transparency, clipping plane and threshold of a volume") {
  Target target;
  const glm::vec3 color(0, 0, 0.5f);
  RenderList list = volume_list(std::make_shared<const qnv::Volume>(random_volume(900, 5, 0.12f)));
  list.splats[0].material.transparency = 1;
  CHECK(plain(target.draw(list, color, 9), color));
  list.splats[0].material.transparency = 0;
  target.options.splat_style.least_magnitude = 2;
  CHECK(plain(target.draw(list, color, 9), color));
  target.options.splat_style.least_magnitude = 0;
  list.splats[0].world_from_node = testing::translation({0, 0, -1});
  target.options.splat_style.clip = glm::vec4(0, 0, 1, -0.1f);  // the world's z >= 0.1, in front of the whole volume
  CHECK(plain(target.draw(list, color, 9), color));
  target.options.splat_style.clip = glm::vec4(0, 0, 1, 1);
  (void)target.draw(list, color, 9);
  CHECK(target.statistics.vectors > 300);
  CHECK(target.statistics.vectors < 600);
}

TEST_CASE("draws the nearer of two volumes over the other") {
  Target target;
  const auto of_color = [](qnv::Rgb8 color) {
    auto geometry = std::make_shared<qnv::Volume>(random_volume(4000, 3, 0.05f));
    geometry->description.transfer = {{0, color, 0.99f}, {1, color, 0.99f}};
    return geometry;
  };
  RenderList list = volume_list(of_color({255, 0, 0}));
  list.splats.push_back(list.splats[0]);
  list.splats[0].geometry = shared_geometry(of_color({0, 255, 0}));
  list.splats[1].world_from_node = testing::translation({0, 0, -3});
  target.options.headlight = true;
  for (int turn = 0; turn < 2; ++turn) {
    const Pixels drawn = target.draw(list, {0, 0, 0}, 9);
    const std::uint8_t* middle = drawn.data() + 4 * (kHeight / 2 * kWidth + kWidth / 2);
    CHECK(middle[1] > 80);
    CHECK(middle[0] < middle[1] / 2);
    std::swap(list.splats[0], list.splats[1]);
  }
}

TEST_CASE("lights a volume by its directional lights, the strongest others and the headlight") {
  RenderList list;
  for (int i = 0; i < 7; ++i) {
    Light light;
    light.kind = i < 2 ? Light::Kind::directional : Light::Kind::point;
    light.intensity = 0.1f * static_cast<float>(i);
    light.ambient_intensity = 0.05f;
    list.lights.push_back(light);
  }
  list.lights[1].direction = {0, -1, 0};
  SplatItem item;
  item.directional_lights = {1, 99};
  const auto lights = volume_lights(list, item, glm::mat4(1), {0, 0, -3}, true);
  REQUIRE(lights.size() == 5);
  CHECK(lights[0].directional);
  CHECK(lights[0].place == glm::vec3(0, 1, 0));
  CHECK(lights[0].ambient == Approx(0.5f));
  CHECK(lights[1].color.x == Approx(0.6f));
  CHECK(lights[3].color.x == Approx(0.4f));
  CHECK(lights[4].directional);
  CHECK(lights[4].place == glm::vec3(0, 0, 1));
  const auto none = volume_lights({}, item, glm::mat4(1), {0, 0, -3}, false);
  REQUIRE(none.size() == 1);
  CHECK(none[0].color == glm::vec3(0));
}

TEST_CASE("mixes vectors of intersecting volumes by depth, vector by vector", "[optimised]") {
  const auto first = std::make_shared<const qnv::Volume>(random_volume(900, 5, 0.12f)),
             second = std::make_shared<const qnv::Volume>(random_volume(700, 6, 0.12f));
  const glm::mat4 place = testing::translation({0.3f, 0.1f, 0.2f}) * testing::scale({1.2f, 0.8f, 1});
  RenderList list = volume_list(first);
  list.splats.push_back(volume_list(second, place).splats[0]);
  list.splats[1].material.transparency = 0.3f;
  Target target;
  const VolumeModel models[2] = {volume_model(*first), volume_model(*second)};
  const glm::mat4 camera_from_world = target.view().camera_from_node;
  std::array<VolumeItem, 2> items{item_of(*first, models[0], camera_from_world),
                                  item_of(*second, models[1], camera_from_world * place)};
  items[1].options.opacity *= 0.7f;
  const RayImage exact = exact_volumes(items, target.view());
  for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
    target.options.splats = path;
    for (int turn = 0; turn < 2; ++turn) {
      CHECK(psnr_over(target.draw(list, {0.2f, 0.4f, 0.8f}, 25), exact, {51, 102, 204, 255}) >= 40);
      std::swap(list.splats[0], list.splats[1]);
    }
  }
  // Blending one finished volume over the other gives a different picture.
  Psnr layered;
  const RayImage one = exact_volumes(std::span(items).first(1), target.view()),
                 other = exact_volumes(std::span(items).last(1), target.view());
  for (std::size_t i = 0; i < exact.color.size(); ++i)
    for (int c = 0; c < 3; ++c)
      layered.add(static_cast<double>(exact.color[i][c]),
                  static_cast<double>(one.color[i][c] + (1 - one.color[i].w) * other.color[i][c]));
  CHECK(layered.decibels() < 35);
}

TEST_CASE("hides the volume behind a polygon, and veils the polygon by the volume before it", "[optimised]") {
  const auto geometry = std::make_shared<const qnv::Volume>(random_volume(1500, 5, 0.1f));
  const VolumeModel model = volume_model(*geometry);
  for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
    Target target;
    target.options.splats = path;
    target.options.splat_style.opacity = 0.5f;
    const glm::vec3 yellow(1, 1, 0), blue(0, 0, 1);
    target.clear(blue, 25);
    target.polygon(rectangle(target, 3, 20, 15, 60, 45), yellow);
    target.volumes(volume_list(geometry));
    const Pixels drawn = target.read();
    std::vector<float> stops(kWidth * kHeight, kInfinity);
    Pixels under(drawn.size());
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool covered = x >= 20 && x < 60 && y >= 15 && y < 45;
        if (covered) stops[index_of(x, y)] = 3;
        for (int c = 0; c < 3; ++c)
          under[4 * index_of(x, y) + static_cast<std::size_t>(c)] =
              static_cast<std::uint8_t>((covered ? yellow : blue)[c] * 255);
      }
    VolumeItem item = item_of(*geometry, model, target.view().camera_from_node);
    item.options.opacity = 0.5f;
    const RayImage exact = exact_volumes(std::span(&item, 1), target.view(), stops);
    CHECK(psnr_over(drawn, exact, under) >= 40);
    // The picture shows neither the polygon alone nor the whole volume in front of it.
    const RayImage all = exact_volumes(std::span(&item, 1), target.view());
    CHECK(psnr_over(drawn, all, under) < 35);
    CHECK(glm::distance(pixel_color(drawn, 40, 30), yellow) > 0.1f);
  }
}

TEST_CASE("smooths polygon edges before, in and behind a volume with several samples", "[optimised]") {
  auto geometry = std::make_shared<qnv::Volume>(random_volume(6000, 5, 0.08f));
  geometry->description.transfer = {{0, {255, 255, 255}, 0.9f}, {1, {255, 255, 255}, 0.9f}};
  for (const float depth : {1.0f, 3.0f, 6.0f}) {
    std::array<Pixels, 2> drawn;
    std::size_t path = 0;
    for (const SplatPath chosen : {SplatPath::cpu, SplatPath::gl}) {
      Target target(SortMethod::automatic, kWidth, kHeight, 4);
      target.options.splats = chosen;
      const auto draw = [&](bool polygon, bool volume) {
        target.clear({0, 0, 1}, 25);
        // The left edge of the polygon halves column 30.
        if (polygon) target.polygon(rectangle(target, depth, 30.5f, -5, 90, 70), {1, 0, 0});
        if (volume) target.volumes(volume_list(geometry));
        return target.read();
      };
      drawn[path] = draw(true, true);
      const Pixels bare = draw(false, true);
      double worst = 0;
      for (int y = 5; y < kHeight - 5; ++y) {
        // Half of the samples of column 30 match the left column, half match the right column.
        const glm::vec3 left = pixel_color(bare, 30, y),
                        right = 0.5f * (pixel_color(drawn[path], 31, y) + pixel_color(drawn[path], 32, y)),
                        middle = pixel_color(drawn[path], 30, y), wanted = 0.5f * (left + right);
        worst = std::max(worst, static_cast<double>(glm::distance(middle, wanted)));
      }
      INFO("depth " << depth << " path " << path);
      CHECK(worst < 0.16);
      ++path;
    }
    CHECK(psnr_of(drawn[0], drawn[1]) >= 40);
  }
}

TEST_CASE("shares the budget between volumes, and compensates for omitted vectors") {
  Target target;
  auto geometry = std::make_shared<qnv::Volume>(random_volume(20'000, 3, 0.05f));
  geometry->description.transfer = {{0, {255, 255, 255}, 0.9f}, {1, {255, 255, 255}, 0.9f}};
  geometry->description.box = {glm::vec3(-1), glm::vec3(1)};
  RenderList list = volume_list(geometry);
  const auto brightness = [&](const Pixels& pixels) {
    double sum = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) sum += i % 4 == 3 ? 0 : pixels[i];
    return sum;
  };
  const double all = brightness(target.draw(list, {0, 0, 0}, 25));
  CHECK(target.statistics.vectors == 20'000);
  for (const std::size_t budget : {100u, 2000u, 2001u, 19'999u, 20'000u, 90'000u}) {
    target.options.budget = budget;
    const double some = brightness(target.draw(list, {0, 0, 0}, 25));
    CHECK(target.statistics.vectors == std::min<std::size_t>(budget, 20'000));
    INFO(budget);
    if (budget >= 2000) CHECK(some == Approx(all).epsilon(0.4));
  }
  auto small = std::make_shared<qnv::Volume>(random_volume(50, 4, 0.05f));
  small->description = geometry->description;
  list.splats.push_back(volume_list(small).splats[0]);
  list.splats.push_back(list.splats[0]);
  target.options.budget = 4050;
  (void)target.draw(list, {0, 0, 0}, 25);
  CHECK(target.statistics.vectors > 3000);
  CHECK(target.statistics.vectors <= 4050);
}

TEST_CASE("applies a chosen transfer function to all volumes, and colours by the source of vectors") {
  Target target;
  const auto geometry = std::make_shared<const qnv::Volume>(random_volume(2000, 5, 0.1f));
  const Pixels own = target.draw(volume_list(geometry), {0, 0, 0}, 25);
  target.options.splat_style.transfer = {{0, {0, 255, 0}, 0.5f}, {1, {0, 255, 0}, 0.5f}};
  const Pixels green = target.draw(volume_list(geometry), {0, 0, 0}, 25);
  // The gloss of the polygon is white but weak.
  CHECK(pixel_color(green, 40, 30).y > 3 * pixel_color(green, 40, 30).x);
  target.options.splat_style.transfer = {{0, {0, 255, 0}, 0}, {1, {0, 255, 0}, 0}};
  CHECK(plain(target.draw(volume_list(geometry), {0, 0, 0}, 25), {0, 0, 0}));
  target.options.splat_style.transfer.clear();
  target.options.splat_style.color_by = ColorBy::age;
  CHECK(psnr_of(target.draw(volume_list(geometry), {0, 0, 0}, 25), own) < 30);
  target.options.splat_style.color_by = ColorBy::own;
  CHECK(target.draw(volume_list(geometry), {0, 0, 0}, 25) == own);
}

TEST_CASE("draws a volume inside its viewport only") {
  for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
    Target target(SortMethod::automatic, kWidth, kHeight), whole(SortMethod::automatic, 40, 30);
    target.options.splats = whole.options.splats = path;
    const RenderList list = volume_list(std::make_shared<const qnv::Volume>(random_volume(900, 5, 0.12f)));
    const Pixels wanted = whole.draw(list, {0, 0, 0.5f}, 25);
    target.clear({0, 0, 0.5f}, 25);
    target.options.x = 30;
    target.options.y = 20;
    target.options.width = 40;
    target.options.height = 30;
    target.gl.Viewport(30, 20, 40, 30);
    target.gl.Scissor(30, 20, 40, 30);
    target.gl.Enable(GL_SCISSOR_TEST);
    target.volumes(list);
    target.gl.Disable(GL_SCISSOR_TEST);
    const Pixels drawn = target.read();
    std::size_t wrong = 0;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const bool inside = x >= 30 && x < 70 && y >= 20 && y < 50;
        for (std::size_t c = 0; c < 3; ++c) {
          const int is = drawn[4 * index_of(x, y) + c],
                    should =
                        inside
                            ? wanted[4 * (static_cast<std::size_t>(y - 20) * 40 + static_cast<std::size_t>(x - 30)) + c]
                            : (c == 2 ? 128 : 0);
          if (std::abs(is - should) > 1) ++wrong;
        }
      }
    CHECK(wrong == 0);
  }
}

TEST_CASE("combines volumes with polygons for all depth formats, and without a depth buffer", "[optimised]") {
  const auto geometry = std::make_shared<const qnv::Volume>(random_volume(1500, 5, 0.1f));
  for (const int samples : {1, 4}) {
    Pixels wanted;
    for (const GLenum format : {GL_DEPTH_COMPONENT24, GL_DEPTH24_STENCIL8, GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT32F,
                                GL_DEPTH32F_STENCIL8, GL_NONE}) {
      for (const auto& [path, reversed] : {std::pair(SplatPath::cpu, false), std::pair(SplatPath::gl, false),
                                           std::pair(SplatPath::cpu, true), std::pair(SplatPath::gl, true)}) {
        Target target(SortMethod::automatic, kWidth, kHeight, samples, static_cast<GLenum>(format));
        if (reversed && !target.reverse_depth()) continue;
        target.options.splats = path;
        target.clear({0, 0, 1}, 25);
        if (format != GL_NONE) target.polygon(rectangle(target, 3, 20.5f, 15.2f, 60, 45), {1, 1, 0});
        target.volumes(volume_list(geometry));
        const Pixels drawn = target.read();
        if (wanted.empty()) wanted = drawn;
        INFO("format " << format << " samples " << samples << " path " << static_cast<int>(path) << " reversed "
                       << reversed);
        if (format != GL_NONE) {
          CHECK(psnr_of(drawn, wanted) >= 40);
          continue;
        }
        // The target has eight bits per component.
        const VolumeModel model = volume_model(*geometry);
        const VolumeItem item = item_of(*geometry, model, target.view().camera_from_node);
        const double psnr = psnr_over(drawn, exact_volumes(std::span(&item, 1), target.view()), {0, 0, 255, 255});
        INFO(psnr);
        CHECK(psnr >= 40);
      }
    }
  }
}
