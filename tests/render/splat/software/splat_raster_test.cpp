#include "render/splat/software/splat_raster.h"

#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/reader/stream_decoder.h"
#include "render/splat/software/splat_kernel.h"
#include "tests/geometries.h"
#include "tests/render/geometry_shapes.h"
#include "tests/render/rays/raycast.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <span>

using namespace gs;
using namespace gs::test;
using render::SplatLayer;
using render::SplatView;

namespace {

/// Agreement of normals, coverage and depth in 0..1, and of colours where both are covered.
struct Agreement {
  double normals, coverage, colors, depth;
};

Agreement against_oracle(const qnv::Splats& geometry, const SplatView& view) {
  const render::SplatPiece whole{&geometry, 0, geometry.size()};
  const bool smooth = render::measure_surface(std::span(&whole, 1), view, geometry.size()).smooth;
  const SplatLayer layer = render::rasterize_surface(geometry, view);
  const render::RaySurface exact = raycast_surface(geometry, view, smooth);
  REQUIRE(layer.width == view.width);
  REQUIRE(exact.width == view.width);
  Psnr normals, coverage, colors, depth;
  for (std::size_t i = 0; i < exact.normal.size(); ++i) {
    const bool both = layer.normals[4 * i + 3] > 0 && exact.normal[i].w > 0;
    coverage.add(layer.normals[4 * i + 3] / 65535.0, static_cast<double>(exact.normal[i].w));
    for (int c = 0; c < 3 && both; ++c) {
      const std::size_t at = 4 * i + static_cast<std::size_t>(c);
      normals.add(layer.normals[at] / 65535.0, static_cast<double>(exact.normal[i][c]) * 0.5 + 0.5);
      if (!layer.colors.empty()) colors.add(layer.colors[at] / 255.0, static_cast<double>(exact.color[i][c]));
    }
    if (both) depth.add(static_cast<double>(layer.depth[i]) / 10, static_cast<double>(exact.depth[i]) / 10);
  }
  REQUIRE(normals.count() > 300);
  return {normals.decibels(), coverage.decibels(), colors.decibels(), depth.decibels()};
}

void check_agreement(const qnv::Splats& geometry, const SplatView& view) {
  const Agreement a = against_oracle(geometry, view);
  CHECK(a.normals >= 40);
  CHECK(a.coverage >= 40);
  CHECK(a.colors >= 40);
  CHECK(a.depth >= 40);
}

/// Returns a unit sphere as an octree with about this many splats.
qnv::Splats finely_cut_sphere(std::size_t vectors) {
  const qnv::TriangleSource source = [](const qnv::TriangleSink& sink) {
    constexpr int kAround = 128, kDown = 64;
    const auto corner = [](int i, int j) {
      const float u = static_cast<float>(i) * 6.2831853f / kAround, v = static_cast<float>(j) * 3.14159265f / kDown;
      return glm::vec3(std::sin(v) * std::cos(u), std::cos(v), -std::sin(v) * std::sin(u));
    };
    std::vector<qnv::Triangle> triangles;
    const auto put = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
      qnv::Triangle t;
      t.positions = t.normals = {a, b, c};
      triangles.push_back(t);
    };
    for (int j = 0; j < kDown; ++j)
      for (int i = 0; i < kAround; ++i) {
        if (j + 1 < kDown) put(corner(i, j), corner(i, j + 1), corner(i + 1, j + 1));
        if (j > 0) put(corner(i, j), corner(i + 1, j + 1), corner(i + 1, j));
      }
    return sink(triangles);
  };
  qnv::EncodeOptions options;
  options.vectors = vectors;
  auto encoded = qnv::encode_surface(source, options);
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
  qnv::StreamDecoder decoder;
  REQUIRE(decoder.push(std::get<qnv::EncodedStream>(encoded).bytes));
  decoder.finish();
  return content_of<qnv::Splats>(decoder.geometry());
}

/// Returns splats of all sizes, directions, colours and cubes at any position, including the viewer's.
qnv::Splats random_discs(std::size_t count) {
  std::mt19937 random(12);
  std::uniform_real_distribution<float> part(0, 1);
  qnv::Splats geometry;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 place(part(random) - 0.5f, part(random) - 0.5f, part(random) - 0.5f);
    add(geometry, place * 3.0f, random_direction(random), 1e-6f * std::pow(1e5f, part(random)));
    geometry.colors.push_back({static_cast<std::uint8_t>(random()), static_cast<std::uint8_t>(random()), 7});
    geometry.cells.push_back({i % 3 == 0 ? 0 : 0.2f * part(random), 0.1f * (part(random) - 0.5f)});
  }
  return geometry;
}

std::size_t covered_pixels(const SplatLayer& layer) {
  std::size_t covered = 0;
  for (std::size_t i = 3; i < layer.normals.size(); i += 4) covered += layer.normals[i] > 0 ? 1 : 0;
  return covered;
}

bool same(const SplatLayer& a, const SplatLayer& b) {
  return a.width == b.width && a.height == b.height && a.depth == b.depth && a.normals == b.normals &&
         a.colors == b.colors && a.discs == b.discs && a.drawn == b.drawn;
}

}  // namespace

TEST_CASE("splats spheres like the reference ray caster") {
  for (const std::size_t count : {60u, 400u, 2500u}) {
    const qnv::Splats geometry = disc_sphere(count, 1);
    for (const glm::vec3& eye : {glm::vec3(0, 0, 3), glm::vec3(2, -2, 1), glm::vec3(-8, 1, 0)}) {
      INFO(count << " discs from " << eye.x << " " << eye.y << " " << eye.z);
      check_agreement(geometry, view_from(eye, 90, 70));
    }
  }
}

TEST_CASE("splats octrees, two-sided surfaces and several samples like the reference ray caster") {
  qnv::Splats geometry = finely_cut_sphere(800);
  REQUIRE(geometry.size() > 300);
  REQUIRE(!geometry.cells.empty());
  SplatView view = view_from({1, 1, 2.5f}, 80, 64);
  SECTION("as it is") { check_agreement(geometry, view); }
  SECTION("with four samples a pixel") {
    view.supersample = 2;
    check_agreement(geometry, view);
  }
  SECTION("with sixteen samples a pixel") {
    view = view_from({1, 1, 2.5f}, 41, 33);
    view.supersample = 4;
    check_agreement(geometry, view);
  }
  SECTION("seen from within") {
    geometry.description.two_sided = true;
    view.camera_from_node = glm::lookAt(glm::vec3(0.1f, 0, 0.2f), glm::vec3(1, 0.2f, 0), glm::vec3(0, 1, 0));
    check_agreement(geometry, view);
  }
  SECTION("drawn out") {
    view.camera_from_node = view.camera_from_node * glm::mat4(glm::vec4(1.3f, 0.2f, 0, 0), glm::vec4(0, 0.8f, 0, 0),
                                                              glm::vec4(0, 0, 1, 0), glm::vec4(0, 0.1f, 0, 1));
    check_agreement(geometry, view);
  }
}

TEST_CASE("splats over many tiles like the reference ray caster") {
  qnv::Splats geometry;
  for (int i = 0; i < 3; ++i) {
    add(geometry, {0.2f * static_cast<float>(i) - 0.3f, 0.1f, -2.0f - 0.1f * static_cast<float>(i)},
        glm::normalize(glm::vec3(0.3f, 0.2f * static_cast<float>(i), 1)), 0.3f + 0.2f * static_cast<float>(i));
    geometry.colors.push_back({static_cast<std::uint8_t>(80 * i), 200, 30});
  }
  SplatView view = straight_view(1001, 777);
  view.tangents *= 0.4f;
  check_agreement(geometry, view);
}

TEST_CASE("splats a surface to the same bits on any number of threads") {
  const qnv::Splats geometry = disc_sphere(60'000, 1);
  SplatView view = view_from({1, 0, 3}, 220, 180);
  view.supersample = 2;
  view.threads = 1;
  const SplatLayer one = render::rasterize_surface(geometry, view);
  REQUIRE(!one.empty());
  for (const unsigned threads : {2u, 3u, 8u}) {
    view.threads = threads;
    CHECK(same(one, render::rasterize_surface(geometry, view)));
  }
}

TEST_CASE("splats a surface to the same bits in all kernels", "[optimised]") {
  const std::span<const render::SplatKernel> kernels = render::splat_kernels();
  REQUIRE(!kernels.empty());
  std::vector<qnv::Splats> geometries{disc_sphere(300, 1), disc_sphere(20'001, 1), finely_cut_sphere(3000)};
  geometries.push_back(random_discs(5000));
  for (std::size_t c = 0; c < geometries.size(); ++c) {
    const render::SplatPiece whole{&geometries[c], 0, geometries[c].size()};
    for (int kind = 0; kind < 8; ++kind) {
      geometries[c].description.two_sided = (kind & 1) != 0;
      INFO("geometry " << c << ", kind " << kind);
      SplatView view = view_from({0.3f, 0.2f, kind & 2 ? 1.1f : 2.7f}, 203, 151);
      view.supersample = kind & 4 ? 2 : 1;
      const SplatLayer first = render::rasterize_surface(std::span(&whole, 1), view, kernels.front());
      REQUIRE(!first.empty());
      CHECK(covered_pixels(first) > 1000);
      for (const render::SplatKernel& kernel : kernels.subspan(1)) {
        INFO("geometry " << c << ", kind " << kind << ", " << kernels.front().name << " and " << kernel.name);
        CHECK(same(first, render::rasterize_surface(std::span(&whole, 1), view, kernel)));
      }
    }
  }
}

TEST_CASE("draws tints of pieces and normal colours instead of stored colours") {
  const qnv::Splats colored = disc_sphere(2500, 1);
  qnv::Splats plain = colored;
  plain.colors.clear();
  plain.color = {10, 20, 30};
  SplatView view = view_from({3, 0.2f, 0.1f}, 120, 90);
  const qnv::Rgb8 tint{250, 3, 77};
  // Returns the colours of the pixels that a sphere of splats covers.
  const auto colors_of = [&](const qnv::Splats& geometry, std::optional<qnv::Rgb8> of) {
    const render::SplatPiece piece{&geometry, 0, geometry.size(), 1, of};
    SplatLayer layer = render::rasterize_surface(std::span(&piece, 1), view);
    REQUIRE(covered_pixels(layer) > 2000);
    return layer;
  };
  CHECK(colors_of(plain, std::nullopt).colors.empty());
  for (const qnv::Splats* geometry : std::initializer_list<const qnv::Splats*>{&plain, &colored}) {
    const SplatLayer layer = colors_of(*geometry, tint);
    REQUIRE(layer.colors.size() == 4u * 120 * 90);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < layer.depth.size(); ++i) {
      const bool covered = layer.normals[4 * i + 3] > 0;
      const qnv::Rgb8 wanted = covered ? tint : qnv::Rgb8{0, 0, 0};
      if (layer.colors[4 * i] != wanted.r || layer.colors[4 * i + 1] != wanted.g || layer.colors[4 * i + 2] != wanted.b)
        ++wrong;
    }
    CHECK(wrong == 0);
  }
  // One half has a tint, the other half has its own colours.
  const std::size_t half = plain.size() / 2;
  const render::SplatPiece halves[] = {{&plain, 0, half, 1, tint}, {&plain, half, plain.size() - half}};
  const SplatLayer two = render::rasterize_surface(halves, view);
  std::size_t tinted = 0, own = 0;
  for (std::size_t i = 0; i < two.depth.size(); ++i) {
    if (two.normals[4 * i + 3] == 0) continue;
    tinted += two.colors[4 * i] == 250 && two.colors[4 * i + 2] == 77 ? 1 : 0;
    own += two.colors[4 * i] == 10 && two.colors[4 * i + 2] == 30 ? 1 : 0;
  }
  CHECK(tinted > 1000);
  CHECK(own > 1000);

  view.color_by_normal = true;
  const glm::mat3 node_from_camera = glm::transpose(glm::mat3(view.camera_from_node));
  for (const auto& of : {std::optional<qnv::Rgb8>(), std::optional<qnv::Rgb8>(tint)}) {
    const SplatLayer layer = colors_of(colored, of);
    float most = 0;
    for (std::size_t i = 0; i < layer.depth.size(); ++i) {
      if (layer.normals[4 * i + 3] == 0) continue;
      glm::vec3 n;
      for (int c = 0; c < 3; ++c)
        n[c] = static_cast<float>(layer.normals[4 * i + static_cast<std::size_t>(c)]) / 32767.5f - 1;
      n = (node_from_camera * n) * 127.5f + 127.5f;
      for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(n[c] - layer.colors[4 * i + static_cast<std::size_t>(c)]));
    }
    CHECK(most < 3);
  }
}

TEST_CASE("thins splats that cover too many samples, equally on any number of threads") {
  qnv::Splats geometry;
  constexpr std::size_t kDiscs = 40'000;
  for (std::size_t i = 0; i < kDiscs; ++i) add(geometry, {0, 0, -2 - 1e-5f * static_cast<float>(i)}, {0, 0, 1}, 200);
  SplatView view = straight_view(150, 100);
  const render::SplatPiece whole{&geometry, 0, geometry.size()};
  const std::span<const render::SplatPiece> pieces(&whole, 1);
  const render::SurfaceMeasure survey = render::measure_surface(pieces, view, kDiscs);
  CHECK(survey.samples == 150.0 * 100 * kDiscs);
  CHECK(render::rasterize_surface(pieces, straight_view(4, 3)).drawn == kDiscs);
  constexpr std::uint64_t kMax = 20'000'000;
  const render::SplatKernel& kernel = render::splat_kernels().front();
  view.threads = 1;
  const SplatLayer thin = render::rasterize_surface(pieces, view, kernel, kMax);
  CHECK(thin.discs == kDiscs);
  // Each preparing task may exceed the limit by one splat.
  CHECK(thin.drawn * 150 * 100 <= kMax + 3 * 150 * 100);
  CHECK(thin.drawn >= kMax / (150 * 100) / 2);
  CHECK(covered_pixels(thin) == 150u * 100);
  for (const unsigned threads : {2u, 5u}) {
    view.threads = threads;
    CHECK(same(thin, render::rasterize_surface(pieces, view, kernel, kMax)));
  }
}

TEST_CASE("draws a plane of splats without holes at any distance", "[optimised]") {
  qnv::Splats geometry;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> shift(-0.05f, 0.05f);
  for (int y = -60; y <= 60; ++y)
    for (int x = -60; x <= 60; ++x) {
      add(geometry, {static_cast<float>(x) + shift(random), static_cast<float>(y) + shift(random), 0}, {0, 0, 1}, 1);
      geometry.description.box.add(geometry.positions.back());
    }
  for (const float distance : {0.7f, 3.0f, 10.0f, 33.0f, 100.0f, 333.0f, 2000.0f}) {
    for (const float slant : {0.0f, 0.9f}) {
      SplatView view = straight_view(180, 120);
      const glm::vec3 eye(distance * std::sin(slant), 0, distance * std::cos(slant));
      view.camera_from_node = glm::lookAt(eye, glm::vec3(0), glm::vec3(0, 1, 0));
      const SplatLayer layer = render::rasterize_surface(geometry, view);
      REQUIRE(!layer.empty());
      const glm::mat4 node_from_camera = glm::inverse(view.camera_from_node);
      std::size_t inside = 0, holes = 0;
      for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
          const glm::vec3 ray =
              glm::mat3(node_from_camera) *
              glm::vec3(((static_cast<float>(x) + 0.5f) / 90 - 1) * 1.5f, (static_cast<float>(y) + 0.5f) / 60 - 1, -1);
          if (!(ray.z < 0)) continue;
          // Skips splats that are edge on, at the horizon.
          if (ray.z * ray.z < 0.03f * 0.03f * glm::dot(ray, ray)) continue;
          const glm::vec3 hit = eye + ray * (-eye.z / ray.z);
          if (std::abs(hit.x) > 59 || std::abs(hit.y) > 59 || -eye.z / ray.z < 0.02f) continue;
          ++inside;
          if (layer.normals[4 * static_cast<std::size_t>(y * view.width + x) + 3] == 0) ++holes;
        }
      INFO("distance " << distance << " slant " << slant << ", " << inside << " pixels");
      CHECK((inside > 0 || distance > 1000));
      CHECK(holes == 0);
    }
  }
}

TEST_CASE("keeps the silhouette of an octree sphere within half a voxel") {
  for (const std::size_t vectors : {600u, 6000u}) {
    const qnv::Splats geometry = finely_cut_sphere(vectors);
    float edge = 0;
    for (const qnv::Cell& cell : geometry.cells) edge = std::max(edge, cell.edge);
    REQUIRE(edge > 0);
    for (const glm::vec3& eye : {glm::vec3(0, 0, 4), glm::vec3(2, 2.5f, 2), glm::vec3(-3, 0.5f, 3)}) {
      const SplatView view = view_from(eye, 240, 240);
      const SplatLayer layer = render::rasterize_surface(geometry, view);
      REQUIRE(!layer.empty());
      const float distance = std::sqrt(glm::dot(eye, eye));
      std::size_t beyond = 0, missing = 0, inside = 0;
      for (int y = 0; y < view.height; ++y)
        for (int x = 0; x < view.width; ++x) {
          const glm::vec3 ray((static_cast<float>(x) + 0.5f - 120) / 240, (static_cast<float>(y) + 0.5f - 120) / 240,
                              -1);
          // Distance of the ray from the sphere's centre.
          const float along = distance / glm::dot(ray, ray);
          const glm::vec3 nearest = ray * along + glm::vec3(0, 0, distance);
          const float miss = std::sqrt(glm::dot(nearest, nearest));
          const bool covered = layer.normals[4 * static_cast<std::size_t>(y * view.width + x) + 3] > 0;
          if (covered && miss > 1 + 0.5f * edge) ++beyond;
          if (miss < 1 - 0.5f * edge) {
            ++inside;
            if (!covered) ++missing;
          }
        }
      INFO(geometry.size() << " discs, voxels of " << edge << ", " << inside << " pixels");
      CHECK(inside > 5000);
      CHECK(beyond == 0);
      // Planes in neighbouring cubes leave a few pixels open if they are seen nearly edge-on.
      CHECK(missing <= inside / 500);
    }
  }
}

TEST_CASE("draws or skips hostile surfaces") {
  const qnv::Splats sound = disc_sphere(300, 1);
  for (const float v : {kNaN, kInfinity, -kInfinity, 0.0f, -1.0f, 1e38f, 1e-38f}) {
    for (int what = 0; what < 5; ++what) {
      qnv::Splats geometry = sound;
      SplatView view = view_from({0, 0, 3}, 70, 40);
      if (what == 3) geometry.cells.resize(geometry.size());
      for (std::size_t i = 0; i < geometry.size(); i += 3) {
        if (what == 0) geometry.positions[i].x = v;
        if (what == 1) geometry.normals[i].y = v;
        if (what == 2) geometry.weights[i] = v;
        if (what == 3) geometry.cells[i] = {v, v};
      }
      if (what == 4) view.camera_from_node[2][0] = v;
      const SplatLayer layer = render::rasterize_surface(geometry, view);
      CHECK((layer.empty() || layer.depth.size() == 70u * 40));
      (void)raycast_surface(geometry, view_from({0, 0, 3}, 7, 4), false);
    }
  }
}
