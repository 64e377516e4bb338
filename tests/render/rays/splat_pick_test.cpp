#include "render/rays/splat_pick.h"

#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/shared/encode_options.h"
#include "tests/render/geometry_shapes.h"
#include "tests/render/rays/raycast.h"
#include "tests/render/splat_scenes.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <limits>
#include <random>

namespace {

using namespace gs;
using namespace gs::render;
using test::add;
using test::kInfinity;
using test::kNaN;
using testing::kPi;

constexpr glm::vec3 kUp(0, 0, 1);

/// Returns one splat of radius 1 at `center`, facing +z.
qnv::Splats disc_at(const glm::vec3& center) {
  qnv::Splats geometry;
  add(geometry, center, kUp, kPi);
  return geometry;
}
PickRay down(float x, float y, float z = 5) {
  PickRay ray;
  ray.origin = {x, y, z};
  return ray;
}
const glm::mat4 kHere(1);

/// Returns the ray through the centre of a pixel, in node space. Sets `slant` to the length of the ray relative to its
/// depth along the axis.
PickRay through(const SplatView& view, int x, int y, float& slant) {
  const glm::mat4 world_from_camera = glm::inverse(view.camera_from_node);
  const glm::vec3 seen(((static_cast<float>(x) + 0.5f) / static_cast<float>(view.width) * 2 - 1) * view.tangents.x,
                       ((static_cast<float>(y) + 0.5f) / static_cast<float>(view.height) * 2 - 1) * view.tangents.y,
                       -1);
  slant = glm::length(seen);
  PickRay ray;
  ray.origin = glm::vec3(world_from_camera[3]);
  ray.direction = glm::normalize(glm::mat3(world_from_camera) * seen);
  ray.pixel = 2 * view.tangents.y / static_cast<float>(view.height);
  return ray;
}

/// Returns the distance of the nearest splat on the ray.
std::optional<float> pick_surface(const qnv::Geometry& geometry, const glm::dmat4& world_from_node, const PickRay& ray,
                                  const PickLimits& limits = {}) {
  const auto hit = pick_disc(geometry, world_from_node, ray, limits);
  return hit ? std::optional(hit->distance) : std::nullopt;
}

/// Returns the share of pixels that agree with the exact ray caster. The picker measures pixels along the ray, the ray
/// caster along the view axis, so outlines differ slightly.
double agreement(const qnv::Geometry& geometry, const SplatView& view) {
  const RaySurface picture = raycast_surface(*geometry.as<qnv::Splats>(), view, false);
  std::size_t equal = 0, all = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      float slant = 1;
      const PickRay ray = through(view, x, y, slant);
      const auto hit = pick_surface(geometry, kHere, ray);
      const float depth = picture.depth[static_cast<std::size_t>(y * view.width + x)];
      equal += hit.has_value() == (depth > 0) && (!hit || std::abs(*hit / slant - depth) < 1e-4f * depth) ? 1 : 0;
      ++all;
    }
  return static_cast<double>(equal) / static_cast<double>(all);
}

/// Returns a stream with levels.
std::shared_ptr<const qnv::Geometry> leveled_sphere(std::size_t vectors) {
  qnv::EncodeOptions options;
  options.vectors = vectors;
  std::vector<qnv::Triangle> triangles;
  const auto point = [](int row, int column) {
    const float theta = kPi * static_cast<float>(row) / 32, phi = kPi * static_cast<float>(column) / 32;
    return glm::vec3(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
  };
  for (int row = 0; row < 32; ++row)
    for (int column = 0; column < 64; ++column)
      for (const bool second : {false, true}) {
        const glm::vec3 a = point(row, column), b = point(row + 1, column + (second ? 1 : 0)),
                        c = second ? point(row, column + 1) : point(row + 1, column + 1);
        if (glm::length(glm::cross(b - a, c - a)) < 1e-6f) continue;
        qnv::Triangle triangle;
        triangle.positions = {a, b, c};
        triangle.normals = {a, b, c};
        triangles.push_back(triangle);
      }
  auto encoded =
      qnv::encode_surface([&](const qnv::TriangleSink& sink) { return sink(std::span(triangles)); }, options);
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
  auto opened = qnv::LodStream::open(std::move(std::get<qnv::EncodedStream>(encoded).bytes));
  REQUIRE(std::holds_alternative<std::unique_ptr<qnv::LodStream>>(opened));
  return std::make_shared<const qnv::Geometry>(
      qnv::OctreeSplats(std::move(std::get<std::unique_ptr<qnv::LodStream>>(opened))));
}

}  // namespace

TEST_CASE("meets a splat as far out as it is drawn") {
  const qnv::Splats geometry = disc_at({0, 0, 1});
  REQUIRE(pick_surface(geometry, kHere, down(0, 0)));
  CHECK(*pick_surface(geometry, kHere, down(0, 0)) == Approx(4));
  CHECK(pick_surface(geometry, kHere, down(1.69f, 0)));  // kDiscCover times the radius
  CHECK_FALSE(pick_surface(geometry, kHere, down(1.71f, 0)));
  PickRay ray = down(0, 0);
  ray.farthest = 3.9f;
  CHECK_FALSE(pick_surface(geometry, kHere, ray));
  ray = down(0, 0);
  ray.direction = {0, 0, 1};
  CHECK_FALSE(pick_surface(geometry, kHere, ray));
}

TEST_CASE("meets the backs of splats where they are drawn") {
  qnv::Splats geometry = disc_at({0, 0, 0});
  PickRay from_behind = down(0, 0, -3);
  from_behind.direction = {0, 0, 1};
  CHECK_FALSE(pick_surface(geometry, kHere, from_behind));
  geometry.description.two_sided = true;
  REQUIRE(pick_surface(geometry, kHere, from_behind));
  CHECK(*pick_surface(geometry, kHere, from_behind) == Approx(3));
  // Seen edge-on, the splat is invisible.
  PickRay along = down(-5, 0, 0.001f);
  along.direction = {1, 0, 0};
  CHECK_FALSE(pick_surface(geometry, kHere, along));
}

TEST_CASE("returns the colour of a splat that has one") {
  qnv::Splats geometry = disc_at({0, 0, 1});
  const auto plain = pick_disc(geometry, kHere, down(0, 0));
  REQUIRE(plain);
  CHECK(plain->distance == Approx(4));
  CHECK_FALSE(plain->color);
  geometry.colors = {{1, 2, 3}};
  CHECK(pick_disc(geometry, kHere, down(0, 0))->color == qnv::Rgb8{1, 2, 3});
  // The ray hits the nearer of two splats.
  add(geometry, {0, 0, 2}, {0, 0, 1}, 3.14f);
  geometry.colors.push_back({7, 8, 9});
  CHECK(pick_disc(geometry, kHere, down(0, 0))->color == qnv::Rgb8{7, 8, 9});
  geometry.colors.pop_back();
  CHECK_FALSE(pick_disc(geometry, kHere, down(0, 0))->color);  // arrays of different lengths
}

TEST_CASE("measures distances in world space under any affine matrix, and splats in node space") {
  const qnv::Splats geometry = disc_at({0, 0, 1});
  const glm::mat4 place = glm::translate(glm::mat4(1), {10, 0, 0}) * glm::scale(glm::mat4(1), {3, 0.5f, 2});
  const auto hit = pick_surface(geometry, place, down(10, 0));
  REQUIRE(hit);
  CHECK(*hit == Approx(3));  // the disc lies at z = 2
  CHECK(pick_surface(geometry, place, down(10 + 3 * 1.69f, 0)));
  CHECK_FALSE(pick_surface(geometry, place, down(10 + 3 * 1.71f, 0)));
  CHECK(pick_surface(geometry, place, down(10, 0.5f * 1.69f)));
  CHECK_FALSE(pick_surface(geometry, place, down(10, 0.5f * 1.71f)));
  const glm::mat4 mirrored = glm::scale(place, {-1, 1, 1});
  CHECK(pick_surface(geometry, mirrored, down(10 - 3 * 1.69f, 0)));
  CHECK_FALSE(pick_surface(geometry, glm::mat4(0.0f), down(0, 0)));
  CHECK_FALSE(pick_surface(geometry, glm::scale(glm::mat4(1), {1, 1, 0}), down(0, 0)));
}

TEST_CASE("meets splats of an octree only in their voxel and its margin") {
  qnv::Splats geometry = disc_at({0, 0, 0.1f});
  geometry.cells.push_back({1, 0.1f});  // from -0.5 to 0.5
  CHECK(pick_surface(geometry, kHere, down(0.59f, -0.59f)));
  CHECK_FALSE(pick_surface(geometry, kHere, down(0.61f, 0)));
  CHECK(*pick_surface(geometry, kHere, down(0, 0)) == Approx(4.9f));
  geometry.description.two_sided = true;
  PickRay from_behind = down(0.39f, 0, -3);
  from_behind.direction = {0, 0, 1};
  CHECK(pick_surface(geometry, kHere, from_behind));
  from_behind.origin.x = 0.41f;  // backs have a smaller margin
  CHECK_FALSE(pick_surface(geometry, kHere, from_behind));
}

TEST_CASE("meets splats smaller than a pixel where they are drawn") {
  qnv::Splats geometry;
  add(geometry, {0, 0, 0}, kUp, 1e-12f);
  PickRay ray = down(0.005f, 0, 10);
  ray.pixel = 0;
  CHECK_FALSE(pick_surface(geometry, kHere, ray));
  ray.pixel = 0.001f;  // 0.6 pixels are 0.006 units there
  CHECK(pick_surface(geometry, kHere, ray));
  ray.origin.x = 0.007f;
  CHECK_FALSE(pick_surface(geometry, kHere, ray));
}

TEST_CASE("picks surfaces where the exact ray caster sees them", "[optimised]") {
  const SplatView view = test::view_from({0.4f, 0.7f, 2.5f}, 48, 40);
  SECTION("discs") { CHECK(agreement(test::disc_sphere(3000, 0.9f), view) > 0.995); }
  SECTION("tiny discs far away") {
    CHECK(agreement(test::disc_sphere(200000, 0.9f), test::view_from({1, 2, 30}, 24, 20)) > 0.98);
  }
  SECTION("cubes") { CHECK(agreement(*testing::octree_sphere(3000), view) > 0.97); }  // clipped splats: ragged rims
  SECTION("two-sided") {
    qnv::Splats half = test::disc_sphere(3000, 0.9f);
    half.positions.resize(1500), half.normals.resize(1500), half.weights.resize(1500), half.colors.resize(1500);
    half.description.two_sided = true;
    CHECK(agreement(half, view) > 0.995);
  }
}

TEST_CASE("picks the same point with any number of threads and tasks") {
  const qnv::Splats geometry = test::disc_sphere(200000, 1);
  PickLimits one, many;
  one.threads = 1;
  many.threads = 5;
  for (const float x : {0.0f, 0.3f, 0.7f, 0.999f, 1.2f})
    CHECK(pick_surface(geometry, kHere, down(x, 0.1f), one) == pick_surface(geometry, kHere, down(x, 0.1f), many));
}

TEST_CASE("picks among the first splats if there are too many") {
  const qnv::Splats geometry = test::disc_sphere(20000, 1);
  qnv::Splats order;  // orders vectors so that any prefix covers the sphere
  std::vector<std::size_t> indices(geometry.size());
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = i;
  std::shuffle(indices.begin(), indices.end(), std::mt19937(3));
  for (const std::size_t i : indices) add(order, geometry.positions[i], geometry.normals[i], geometry.weights[i]);
  PickLimits limits;
  limits.vectors = 2000;
  std::size_t hits = 0;
  for (int i = 0; i < 100; ++i) {
    const auto hit = pick_surface(order, kHere, down(-0.5f + 0.01f * static_cast<float>(i), 0.2f), limits);
    hits += hit && std::abs(*hit - 4) < 0.5f ? 1 : 0;
  }
  CHECK(hits > 95);
}

TEST_CASE("picks streams with levels at the detail of the picture") {
  const auto geometry = leveled_sphere(60000);
  for (const float x : {0.0f, 0.2f, -0.55f}) {
    const auto hit = pick_surface(*geometry, kHere, down(x, 0.1f));
    REQUIRE(hit);
    CHECK(*hit == Approx(5 - std::sqrt(1 - x * x - 0.01f)).margin(0.01));
  }
  CHECK_FALSE(pick_surface(*geometry, kHere, down(1.2f, 0)));
  // Clusters beside the ray are not decoded.
  qnv::LodStream& stream = *geometry->as<qnv::OctreeSplats>()->stream;
  CHECK(stream.statistics().cached_discs < stream.whole().size());
  const glm::mat4 place = glm::scale(glm::translate(glm::mat4(1), {0, 0, -10}), {20, 1, 4});
  const auto stretched = pick_surface(*geometry, place, down(10, 0));
  REQUIRE(stretched);
  CHECK(*stretched == Approx(15 - 4 * std::sqrt(0.75f)).margin(0.05));
}

TEST_CASE("ignores splats with invalid numbers") {
  qnv::Splats geometry = disc_at({0, 0, 0});
  for (const float bad : {kNaN, kInfinity, -kInfinity, 3e38f, -3e38f}) {
    add(geometry, {0, 0, bad}, kUp, 1);
    add(geometry, {bad, 0, 1}, kUp, 1);
    add(geometry, {0, 0, 2}, {0, 0, bad}, std::isnan(bad) || std::isinf(bad) ? 1.0f : -1.0f);
    add(geometry, {0, 0, 2}, {bad, bad, bad}, 1);
    add(geometry, {0, 0, 2}, kUp, std::isfinite(bad) ? -1.0f : bad);
  }
  REQUIRE(pick_surface(geometry, kHere, down(0, 0)));
  CHECK(*pick_surface(geometry, kHere, down(0, 0)) == Approx(5));
  geometry.cells.resize(geometry.size());
  for (std::size_t i = 0; i < geometry.size(); ++i) geometry.cells[i] = {i % 2 == 0 ? kNaN : kInfinity, kInfinity};
  (void)pick_surface(geometry, kHere, down(0, 0));
  geometry.cells.resize(1);
  CHECK_FALSE(pick_surface(geometry, kHere, down(0, 0)));  // arrays of different lengths
  geometry.cells.clear();
  geometry.normals.pop_back();
  CHECK_FALSE(pick_surface(geometry, kHere, down(0, 0)));
  CHECK_FALSE(pick_surface({}, kHere, down(0, 0)));
  const qnv::Splats one = disc_at({0, 0, 0});
  for (const float bad : {kNaN, kInfinity, 1e30f}) {
    PickRay ray = down(bad, 0);
    CHECK_FALSE(pick_surface(one, kHere, ray));
    ray = down(0, 0);
    ray.direction = {bad, bad, 0};
    CHECK_FALSE(pick_surface(one, kHere, ray));
    CHECK_FALSE(pick_surface(one, glm::mat4(bad), down(0, 0)));
    ray = down(0, 0);
    ray.pixel = bad;
    (void)pick_surface(one, kHere, ray);
  }
}

namespace {

/// Returns layers of 21 x 21 vectors of spacing 0.1 around the z axis, from z = 0 downwards.
qnv::Volume layers_of(int layers, float opacity) {
  qnv::Volume geometry = test::empty_volume(opacity, 0.1f);
  for (int layer = 0; layer < layers; ++layer)
    for (int y = -10; y <= 10; ++y)
      for (int x = -10; x <= 10; ++x)
        add(geometry, {0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), -0.1f * static_cast<float>(layer)},
            kUp, 1, 128);
  geometry.description.box = {{-1, -1, -0.1f * static_cast<float>(layers - 1)}, {1, 1, 0}};
  return geometry;
}

std::optional<VolumePick> pick_here(const qnv::Volume& geometry, const VolumeOptions& options, const PickRay& ray,
                                    const glm::mat4& place = kHere) {
  return pick_volume(geometry, volume_model(geometry), options, place, ray);
}

}  // namespace

TEST_CASE("picks a volume where it absorbs half of the light") {
  const qnv::Volume dense = layers_of(10, 0.9f), thin = layers_of(10, 0.1f);
  const auto first = pick_here(dense, {}, down(0, 0)), deeper = pick_here(thin, {}, down(0, 0));
  REQUIRE((first && deeper));
  CHECK(first->distance == Approx(5).margin(0.11));
  CHECK(first->opacity > 0.99f);
  CHECK(deeper->distance > first->distance + 0.15f);
  CHECK_FALSE(pick_here(dense, {}, down(2, 0)));
  // If no opacity reaches one half, the middle of the volume is hit.
  VolumeOptions faint;
  faint.opacity = 0.1f;
  const auto veil = pick_here(thin, faint, down(0, 0));
  REQUIRE(veil);
  CHECK(veil->opacity < 0.5f);
  CHECK(veil->distance == Approx(5.45).margin(0.11));
  faint.opacity = 1e-4f;
  CHECK_FALSE(pick_here(thin, faint, down(0, 0)));
}

TEST_CASE("picks nothing of a volume that is not drawn") {
  qnv::Volume geometry = layers_of(10, 0.9f);
  VolumeOptions options;
  options.clip = glm::vec4(0, 0, -1, -0.45f);  // keeps z <= -0.45
  CHECK(pick_here(geometry, options, down(0, 0))->distance == Approx(5.5).margin(0.11));
  options = {};
  for (std::size_t i = 0; i < 441 * 3; ++i) geometry.weights[i] = 0.5f;
  options.least_magnitude = 0.75f;
  CHECK(pick_here(geometry, options, down(0, 0))->distance == Approx(5.3).margin(0.11));
  options = {};
  for (std::size_t i = 0; i < 441 * 7; ++i) geometry.classes[i] = 10;
  const std::vector<qnv::TransferPoint> points{{0.2f, {}, 0}, {0.3f, {}, 0.9f}};
  const VolumeTransfer transfer = volume_transfer(geometry.description, points);
  options.transfer = &transfer;
  CHECK(pick_here(geometry, options, down(0, 0))->distance == Approx(5.7).margin(0.11));
  PickRay ray = down(0, 0);
  ray.farthest = 5.65f;
  CHECK_FALSE(pick_here(geometry, options, ray));
}

TEST_CASE("picks a volume at the depth of the exact ray caster") {
  const qnv::Volume geometry = test::random_volume(4000, 7, 0.05f);
  const SplatView view = test::view_from({0.3f, 0.5f, 3}, 32, 24);
  VolumeOptions options;
  const RayImage picture = raycast_volume(geometry, view, options);
  const VolumeModel model = volume_model(geometry);
  std::size_t near = 0, all = 0;
  for (int y = 6; y < 18; ++y)
    for (int x = 8; x < 24; ++x) {
      const float depth = picture.depth[static_cast<std::size_t>(y * view.width + x)];
      if (!(depth > 0)) continue;
      float slant = 1;
      const auto hit = pick_volume(geometry, model, options, kHere, through(view, x, y, slant));
      ++all;
      near += hit && std::abs(hit->distance / slant - depth) < 0.1f ? 1 : 0;
    }
  REQUIRE(all > 100);
  CHECK(near > all * 9 / 10);
}

TEST_CASE("survives volumes of hostile numbers") {
  std::mt19937 random(2);
  const float bad[] = {0, -1, 1, 1e38f, -1e38f, kNaN, kInfinity, -kInfinity, 1e-38f};
  const auto any = [&] { return bad[random() % std::size(bad)]; };
  for (int round = 0; round < 300; ++round) {
    qnv::Volume geometry = test::empty_volume(0.5f, any());
    for (int i = 0; i < 20; ++i) add(geometry, {any(), any(), any()}, {any(), any(), any()}, any(), 100);
    PickRay ray;
    ray.origin = {any(), any(), any()};
    ray.direction = {any(), any(), any()};
    ray.pixel = any();
    glm::mat4 place(1);
    place[static_cast<int>(random() % 4)][static_cast<int>(random() % 3)] = any();
    VolumeOptions options;
    options.opacity = any();
    if (round % 2 == 0) options.clip = glm::vec4(any(), any(), any(), any());
    (void)pick_here(geometry, options, ray, place);
    (void)pick_surface(geometry, place, ray);
  }
  const qnv::Volume geometry = layers_of(2, 0.9f);
  CHECK_FALSE(pick_volume(geometry, {}, {}, kHere, down(0, 0)));
  CHECK_FALSE(pick_here(geometry, {}, down(0, 0), glm::mat4(0.0f)));
}
