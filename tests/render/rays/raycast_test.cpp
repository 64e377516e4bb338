#include "tests/render/rays/raycast.h"

#include "render/splat/software/splat_constants.h"
#include "tests/render/geometry_shapes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

using namespace gs;
using namespace gs::test;
using render::RayImage;
using render::RaySurface;
using render::VolumeOptions;

namespace {

/// Returns options without directional light, so that colours are those of the transfer function.
VolumeOptions flat() {
  VolumeOptions options;
  options.opacity = 1;
  options.ambient = 1;
  options.diffuse = options.specular = 0;
  return options;
}

/// Returns the centre opacity of a vector for a layer's opacity (volume_model.h).
double peak(double opacity) {
  return -std::log(1 - opacity) / (std::numbers::pi * static_cast<double>(render::kVolumeFootprint));
}

std::size_t pixel_index(const RayImage& image, int x, int y) { return static_cast<std::size_t>(y * image.width + x); }

}  // namespace

TEST_CASE("draws one vector of a volume as a Gaussian around its position") {
  qnv::Volume geometry = empty_volume(0.5f, 1);
  geometry.description.box = {{-0.5f, -0.5f, -10.5f}, {0.5f, 0.5f, -9.5f}};
  add(geometry, {0, 0, -10}, {0, 0, 1}, 3, 128);
  const render::VolumeModel model = render::volume_model(geometry);
  REQUIRE(model.spacing.size() == 1);
  // For a cube of edge 2 with one vector, the spacing is 2 sqrt(3 / 1).
  const double s = static_cast<double>(model.spacing[0]);
  CHECK(s == Approx(2 * std::sqrt(3.0)));
  const render::SplatView view = straight_view(101, 101);
  const RayImage image = raycast_volume(geometry, view, flat());
  REQUIRE(image.width == 101);
  const double area = static_cast<double>(render::kVolumeFootprint) * s * s;
  for (const auto& [dx, dy] : {std::pair{0, 0}, std::pair{7, 0}, std::pair{0, -9}, std::pair{12, 5}}) {
    // A pixel is 2 / 101 units wide at depth 1, and 20 / 101 at the vector.
    const double d2 = (dx * dx + dy * dy) * (20.0 / 101) * (20.0 / 101);
    const double alpha = peak(0.5) * std::exp(-d2 / area);
    const glm::vec4 seen = image.color[pixel_index(image, 50 + dx, 50 + dy)];
    CHECK(static_cast<double>(seen.w) == Approx(alpha).epsilon(1e-4));
    CHECK(seen.x == seen.w);  // white
    CHECK(seen.y == seen.w);
  }
  CHECK(image.depth[pixel_index(image, 50, 50)] == 0);  // nowhere half opaque
}

TEST_CASE("blends front over back in any order of the vectors") {
  for (const bool near_first : {true, false}) {
    qnv::Volume geometry = empty_volume(0.9f, 1);
    geometry.description.transfer = {{0, {255, 0, 0}, 0.9f}, {1, {0, 0, 255}, 0.9f}};
    const auto near = [&] { add(geometry, {0, 0, -10}, {0, 0, 1}, 3, 0); };
    const auto far = [&] { add(geometry, {0, 0, -14}, {0, 0, 1}, 3, 255); };
    if (near_first) {
      near();
      far();
    } else {
      far();
      near();
    }
    const RayImage image = raycast_volume(geometry, straight_view(31, 31), flat());
    REQUIRE(!image.empty());
    const double a = peak(0.9);
    REQUIRE(a < 0.95);
    REQUIRE(a > 0.5);
    const glm::vec4 seen = image.color[pixel_index(image, 15, 15)];
    CHECK(static_cast<double>(seen.x) == Approx(a).epsilon(1e-5));
    CHECK(static_cast<double>(seen.z) == Approx(a * (1 - a)).epsilon(1e-5));
    CHECK(static_cast<double>(seen.w) == Approx(1 - (1 - a) * (1 - a)).epsilon(1e-5));
    CHECK(image.depth[pixel_index(image, 15, 15)] == 10);
  }
}

TEST_CASE("returns as depth of a volume the depth of half opacity") {
  qnv::Volume geometry = empty_volume(0.5f, 1);
  for (int i = 0; i < 20; ++i) add(geometry, {0, 0, -10.0f - static_cast<float>(i)}, {0, 0, 1}, 3, 9);
  const RayImage image = raycast_volume(geometry, straight_view(3, 3), flat());
  REQUIRE(!image.empty());
  const int vectors = static_cast<int>(std::ceil(std::log(0.5) / std::log(1 - peak(0.5))));
  REQUIRE(vectors > 1);
  CHECK(image.depth[pixel_index(image, 1, 1)] == static_cast<float>(10 + vectors - 1));
}

TEST_CASE("keeps the integrated opacity of vectors smaller than a pixel") {
  qnv::Volume geometry = empty_volume(0.9f, 0.001f);
  geometry.description.box = {{0, 0, -10}, {0, 0, -10}};
  add(geometry, {0, 0, -10}, {0, 0, 1}, 1, 0);
  const render::VolumeModel model = render::volume_model(geometry);
  const render::SplatView view = straight_view(41, 41);
  const RayImage image = raycast_volume(geometry, view, flat());
  REQUIRE(!image.empty());
  double sum = 0;
  for (const glm::vec4& c : image.color) sum += static_cast<double>(c.w);
  const double edge = 20.0 / 41;  // edge of a pixel
  const double s = static_cast<double>(model.spacing[0]);
  const double whole =
      peak(0.9) * std::numbers::pi * static_cast<double>(render::kVolumeFootprint) * s * s / (edge * edge);
  CHECK(sum == Approx(whole).epsilon(0.04));
}

TEST_CASE("shades a volume by its gradients from both sides") {
  const float h = std::sqrt(0.5f);
  VolumeOptions options = flat();
  options.ambient = 0.2f;
  options.diffuse = 0.8f;
  const render::VolumeLight light{.place = {0, 0, 1}};
  options.lights = {&light, 1};
  CHECK(render::volume_shade(options, glm::vec3(1), {0, 0, -10}, {0, 0, 1}).x == Approx(1));
  CHECK(render::volume_shade(options, glm::vec3(1), {0, 0, -10}, {0, 0, -5}).x == Approx(1));
  CHECK(render::volume_shade(options, glm::vec3(1), {0, 0, -10}, {h, 0, h}).x == Approx(0.2f + 0.8f * h));
  CHECK(render::volume_shade(options, glm::vec3(1), {0, 0, -10}, {kNaN, 0, h}).x == Approx(1));
  for (const auto& [normal, expected] :
       {std::pair{glm::vec3(0, 0, 1), 1.0f}, std::pair{glm::vec3(h, 0, h), 0.2f + 0.8f * h},
        std::pair{glm::vec3(0, 0, -1), 1.0f}, std::pair{glm::vec3(1, 0, 0), 0.2f}}) {
    qnv::Volume geometry = empty_volume(0.9f, 1);
    add(geometry, {0, 0, -10}, normal, 1, 0);
    const RayImage image = raycast_volume(geometry, straight_view(21, 21), options);
    REQUIRE(!image.empty());
    const glm::vec4 seen = image.color[pixel_index(image, 10, 10)];
    CHECK(seen.x / seen.w == Approx(expected));
  }
}

TEST_CASE("lights volumes with attenuation, radius and spot") {
  VolumeOptions options = flat();
  options.ambient = 0;
  options.diffuse = 1;
  render::VolumeLight light;
  light.directional = false;
  light.place = {0, 0, -6};
  light.radius = 10;
  light.attenuation = {0, 0.5f, 0};
  options.lights = {&light, 1};
  const auto seen = [&] { return render::volume_shade(options, glm::vec3(1), {0, 0, -10}, {0, 0, 1}).y; };
  CHECK(seen() == Approx(0.5f));
  light.beam_width = 0.1f;
  light.cut_off_angle = 0.2f;
  light.direction = {0, 0, -1};
  CHECK(seen() == Approx(0.5f));
  light.direction = {0, std::sin(0.15f), -std::cos(0.15f)};
  CHECK(seen() == Approx(0.25f).epsilon(1e-3));
  light.direction = {0, 1, 0};
  CHECK(seen() == 0);
  light.cut_off_angle = 4;
  light.radius = 3;
  CHECK(seen() == 0);
}

TEST_CASE("applies magnitude, threshold and clipping plane") {
  qnv::Volume geometry = empty_volume(0.5f, 1);
  add(geometry, {0, 0, -10}, {0, 0, 1}, 1, 0);
  add(geometry, {0, 0, -11}, {0, 0, 1}, 2, 0);
  add(geometry, {0, 0, -12}, {0, 0, 1}, 4, 0);
  const render::VolumeModel model = render::volume_model(geometry);
  CHECK(model.full_magnitude == 2);
  VolumeOptions options = flat();
  const auto alpha = [&](std::size_t k) { return static_cast<double>(volume_alpha(geometry, model, options, k)); };
  CHECK(alpha(0) == Approx(peak(0.5) / 2));
  CHECK(alpha(1) == Approx(peak(0.5)));
  CHECK(alpha(2) == Approx(peak(0.5)));
  options.opacity = 1000;
  CHECK(alpha(2) == static_cast<double>(render::kVolumeMostAlpha));
  options.least_magnitude = 1.5f;
  CHECK(alpha(0) == 0);
  CHECK(alpha(1) > 0);
  options.clip = glm::vec4(0, 0, 1, 11.5f);  // z >= -11.5
  CHECK(alpha(1) > 0);
  CHECK(alpha(2) == 0);
}

TEST_CASE("enlarges footprints as the number of vectors shrinks") {
  const auto lattice = [](int step) {
    qnv::Volume geometry = empty_volume(0.5f, 1);
    geometry.description.box = {glm::vec3(0), glm::vec3(63)};
    for (int z = 30; z < 33; ++z)
      for (int y = 0; y < 64; y += step)
        for (int x = 0; x < 64; x += step) add(geometry, {x, y, z}, {0, 0, 1}, 1, 0);
    std::vector<float> spacing = render::volume_model(geometry).spacing;
    std::sort(spacing.begin(), spacing.end());
    return spacing[spacing.size() / 2];
  };
  // The spacing is never too small. It is slightly too large if a boundary runs between two cells.
  for (const int step : {1, 2, 4, 8}) {
    const float spacing = lattice(step);
    INFO("every " << step << ": " << spacing);
    CHECK(spacing >= 0.99f * static_cast<float>(step));
    CHECK(spacing <= 1.6f * static_cast<float>(step));
  }
}

TEST_CASE("finds plane, rim and normal of one splat by raycasting") {
  qnv::Splats geometry;
  const float h = std::sqrt(0.5f);
  add(geometry, {0, 0, -10}, {h, 0, h}, static_cast<float>(std::numbers::pi));  // radius 1
  geometry.color = {255, 0, 51};
  const render::SplatView view = straight_view(401, 401);
  const RaySurface seen = raycast_surface(geometry, view, false);
  REQUIRE(seen.width == 401);
  const auto at = [](int x, int y) { return static_cast<std::size_t>(y * 401 + x); };
  CHECK(seen.normal[at(200, 200)].w == 1);
  CHECK(seen.normal[at(200, 200)].x == Approx(h));
  CHECK(seen.depth[at(200, 200)] == Approx(10));
  CHECK(seen.color[at(200, 200)].z == Approx(0.2f));
  // The plane is x + z = -10, and the ray of column c has x = t z, t = -(c - 200) 2 / 401.
  const double t = 10 * 2 / 401.0;  // ten columns at depth 1, or one at depth 10
  CHECK(static_cast<double>(seen.depth[at(210, 200)]) == Approx(10 / (1 - t)).epsilon(1e-5));
  // Vertically, the rim is at kDiscCover radii.
  const int rim = static_cast<int>(static_cast<double>(render::splat::kDiscCover) / t);
  CHECK(seen.normal[at(200, 200 + rim)].w == 1);
  CHECK(seen.normal[at(200, 200 + rim + 1)].w == 0);
  CHECK(seen.depth[at(200, 200 + rim + 1)] == 0);
  // Only a two-sided splat shows its back.
  geometry.normals[0] = -geometry.normals[0];
  CHECK(raycast_surface(geometry, view, false).normal[at(200, 200)].w == 0);
  geometry.description.two_sided = true;
  const RaySurface back = raycast_surface(geometry, view, false);
  CHECK(back.normal[at(200, 200)].w == 1);
  CHECK(back.normal[at(200, 200)].x == Approx(h));  // towards the viewer
}

TEST_CASE("hides a splat behind another, and blends it with its neighbour") {
  qnv::Splats geometry;
  add(geometry, {0, 0, -10}, {0, 0, 1}, 1);
  add(geometry, {0, 0, -12}, {0, 0, 1}, 1);
  geometry.colors = {{255, 0, 0}, {0, 255, 0}};
  RaySurface seen = raycast_surface(geometry, straight_view(101, 101), false);
  REQUIRE(!seen.empty());
  CHECK(seen.color[50 * 101 + 50] == glm::vec4(1, 0, 0, 1));
  CHECK(seen.depth[50 * 101 + 50] == 10);
  // The splats are side by side in one plane. The pixel is halfway between them.
  geometry.positions = {{-0.3f, 0, -10}, {0.3f, 0, -10}};
  seen = raycast_surface(geometry, straight_view(101, 101), false);
  CHECK(seen.color[50 * 101 + 50].x == Approx(0.5f));
  CHECK(seen.color[50 * 101 + 50].y == Approx(0.5f));
}

TEST_CASE("returns an empty picture for no vectors") {
  const VolumeOptions options = flat();
  CHECK(raycast_volume({}, straight_view(4, 4), options).empty());
  CHECK(raycast_surface({}, straight_view(4, 4), false).empty());
  qnv::Volume geometry = empty_volume(0.5f, 1);
  add(geometry, {0, 0, 10}, {0, 0, 1}, 1, 0);  // behind
  CHECK(raycast_volume(geometry, straight_view(4, 4), options).empty());
  CHECK(raycast_volume(geometry, straight_view(0, 4), options).empty());
}
