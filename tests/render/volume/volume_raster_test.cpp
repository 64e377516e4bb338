#include "render/volume/volume_raster.h"

#include "render/volume/volume_tile.h"
#include "tests/render/rays/raycast.h"
#include "tests/render/volume/one_volume.h"
#include "tests/render/volume_scenes.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>
#include <random>

using namespace gs;
using namespace gs::test;
using render::SplatView;
using render::VolumeLayer;
using render::VolumeOptions;

namespace {

VolumeLayer drawn(const qnv::Volume& geometry, const SplatView& view, const VolumeOptions& options = {}) {
  return rasterize_volume(geometry, view, options);
}

/// Returns the agreement of all four components, and the share of clearly opaque pixels with another depth.
std::pair<double, double> against_oracle(const qnv::Volume& geometry, const SplatView& view,
                                         const VolumeOptions& options) {
  const VolumeLayer layer = drawn(geometry, view, options);
  const render::RayImage exact = raycast_volume(geometry, view, options);
  REQUIRE(layer.width == view.width);
  REQUIRE(exact.width == view.width);
  Psnr psnr;
  std::size_t solid = 0, elsewhere = 0;
  for (std::size_t i = 0; i < exact.color.size(); ++i) {
    for (int c = 0; c < 4; ++c)
      psnr.add(layer.pixels[4 * i + static_cast<std::size_t>(c)] / 255.0, static_cast<double>(exact.color[i][c]));
    if (exact.color[i].w < 0.55f) continue;
    ++solid;
    if (std::abs(layer.depth[i] - exact.depth[i]) > 0.05f) ++elsewhere;
  }
  return {psnr.decibels(), static_cast<double>(elsewhere) / static_cast<double>(std::max<std::size_t>(solid, 1))};
}

bool same(const VolumeLayer& a, const VolumeLayer& b) {
  return a.width == b.width && a.height == b.height && a.pixels == b.pixels && a.depth == b.depth &&
         a.vectors == b.vectors;
}

}  // namespace

TEST_CASE("draws a volume as equation (1) defines") {
  const qnv::Volume geometry = random_volume(900, 5, 0.12f);
  for (const glm::vec3& eye : {glm::vec3(0, 0, 3), glm::vec3(3, 1, -1), glm::vec3(-2, -2.5f, 0.5f),
                               glm::vec3(0.9f, 0.2f, 0.3f), glm::vec3(0, 12, 0)}) {
    const SplatView view = view_from(eye, 75, 61);
    const auto [psnr, elsewhere] = against_oracle(geometry, view, {});
    INFO("from " << eye.x << " " << eye.y << " " << eye.z);
    CHECK(psnr >= 40);
    CHECK(elsewhere < 0.02);
  }
}

TEST_CASE("draws lights, threshold, clipping plane, colour and slant as equation (1) defines") {
  const qnv::Volume geometry = random_volume(700, 6, 0.15f);
  SplatView view = view_from({1, 2, 2}, 70, 50);
  const std::array<render::VolumeLight, 2> lights = {
      render::VolumeLight{.place = {0.6f, 0.8f, 0}, .color = {1, 0.5f, 0.2f}},
      render::VolumeLight{.directional = false, .place = {0, 1, -1}, .attenuation = {1, 0.2f, 0}, .radius = 9}};
  VolumeOptions options;
  options.lights = lights;
  CHECK(against_oracle(geometry, view, options).first >= 40);
  options.least_magnitude = 0.5f;
  options.clip = glm::vec4(0.5f, 0.5f, 0, 0.1f);
  CHECK(against_oracle(geometry, view, options).first >= 40);
  options.color = glm::vec3(0.2f, 0.9f, 0.4f);
  options.opacity = 20;
  view.camera_from_node = view.camera_from_node * glm::mat4(glm::vec4(1.2f, 0.3f, 0, 0), glm::vec4(0, 0.7f, 0.2f, 0),
                                                            glm::vec4(0, 0, -1, 0), glm::vec4(0.1f, 0, 0, 1));
  CHECK(against_oracle(geometry, view, options).first >= 40);
}

TEST_CASE("draws many small vectors like the reference ray caster", "[optimised]") {
  const qnv::Volume geometry = random_volume(20'000, 7, 0.02f);
  CHECK(against_oracle(geometry, view_from({0, 1, 3}, 64, 64), {}).first >= 40);
}

TEST_CASE("draws vectors at different depths equally in any order") {
  const qnv::Volume geometry = random_volume(600, 8, 0.2f);
  std::vector<std::size_t> order(geometry.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  qnv::Volume other;
  other.description = geometry.description;
  for (const std::size_t i : order)
    add(other, geometry.positions[i], geometry.normals[i], geometry.weights[i], geometry.classes[i]);
  const SplatView view = view_from({0, 0, 3}, 64, 64);
  CHECK(same(drawn(geometry, view), drawn(other, view)));
}

TEST_CASE("draws the same volume on any number of threads") {
  const qnv::Volume geometry = random_volume(60'000, 9, 0.02f);
  SplatView view = view_from({1, 1, 2}, 200, 150);
  view.threads = 1;
  const VolumeLayer one = drawn(geometry, view);
  REQUIRE(!one.empty());
  for (const unsigned threads : {2u, 3u, 8u}) {
    view.threads = threads;
    CHECK(same(one, drawn(geometry, view)));
  }
}

TEST_CASE("draws several volumes with stops to their exact picture on any number of threads", "[optimised]") {
  const qnv::Volume first = random_volume(30'000, 9, 0.03f), second = random_volume(600, 4, 0.2f);
  const render::VolumeModel models[2] = {render::volume_model(first), render::volume_model(second)};
  SplatView view = view_from({1, 1, 2}, 48, 36);
  std::array<render::VolumeItem, 2> items{
      render::VolumeItem{&first, &models[0], view.camera_from_node, first.size(), {}},
      render::VolumeItem{&second, &models[1], glm::translate(view.camera_from_node, {0.5f, 0, 0}), 500, {}}};
  items[0].options.opacity = 0.2f;
  std::vector<float> near(48 * 36, kInfinity), far(48 * 36, kInfinity);
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (i % 48 > 24) near[i] = far[i] = 2.5f;
    if (i % 48 == 24) near[i] = 2.5f;
    if (i % 48 > 43) near[i] = far[i] = 0.5f;
  }
  view.threads = 1;
  const VolumeLayer one = render::rasterize_volumes(items, view, {near, far});
  REQUIRE(!one.edge_pixels.empty());
  for (const unsigned threads : {2u, 5u}) {
    view.threads = threads;
    const VolumeLayer other = render::rasterize_volumes(items, view, {near, far});
    CHECK(same(one, other));
    CHECK(one.edge_pixels == other.edge_pixels);
  }
  const auto decibels = [&](const std::vector<std::uint8_t>& pixels, std::span<const float> stops) {
    const render::RayImage exact = exact_volumes(items, view, stops);
    Psnr psnr;
    for (std::size_t i = 0; i < exact.color.size(); ++i)
      for (int c = 0; c < 4; ++c)
        psnr.add(pixels[4 * i + static_cast<std::size_t>(c)] / 255.0, static_cast<double>(exact.color[i][c]));
    return psnr.decibels();
  };
  CHECK(decibels(one.pixels, far) >= 40);
  CHECK(decibels(one.edge_pixels, near) >= 40);
  // Stops beyond the volume, and lists of stops with another size, have no effect.
  const std::vector<float> none(48 * 36, kInfinity);
  const VolumeLayer free = render::rasterize_volumes(items, view);
  CHECK(same(free, render::rasterize_volumes(items, view, {none, none})));
  CHECK(same(free, render::rasterize_volumes(items, view, {std::span(near).first(9), {}})));
  CHECK(!same(free, one));
  const std::vector<float> before(48 * 36, 0.1f);
  const VolumeLayer hidden = render::rasterize_volumes(items, view, {before, {}});
  CHECK(std::all_of(hidden.pixels.begin(), hidden.pixels.end(), [](std::uint8_t p) { return p == 0; }));
}

TEST_CASE("draws one of several volumes exactly like the ray caster") {
  const qnv::Volume geometry = random_volume(300, 3, 0.2f);
  const render::VolumeModel model = render::volume_model(geometry);
  const SplatView view = view_from({1, 0.5f, 2.5f}, 30, 20);
  const render::VolumeItem item{&geometry, &model, view.camera_from_node, geometry.size(), {}};
  const render::RayImage a = exact_volumes(std::span(&item, 1), view), b = raycast_volume(geometry, view, {});
  REQUIRE(a.color.size() == b.color.size());
  for (std::size_t i = 0; i < a.color.size(); ++i)
    for (int c = 0; c < 4; ++c) REQUIRE(a.color[i][c] == Approx(b.color[i][c]).margin(1e-5));
}

TEST_CASE("counts the vectors in view") {
  const qnv::Volume geometry = random_volume(5000, 3, 0.05f);
  const render::VolumeModel model = render::volume_model(geometry);
  SplatView view = view_from({0, 0, 3}, 80, 60);
  render::VolumeItem item{&geometry, &model, view.camera_from_node, geometry.size(), {}};
  const std::size_t all = drawn(geometry, view).vectors;
  CHECK(render::survey_volumes(std::span(&item, 1), view, 10'000).vectors == all);
  const render::VolumeSurvey some = render::survey_volumes(std::span(&item, 1), view, 500);
  CHECK(static_cast<double>(some.vectors) == Approx(static_cast<double>(all)).epsilon(0.1));
  CHECK(some.pixels > static_cast<double>(all));
  item.count = 0;
  CHECK(render::survey_volumes(std::span(&item, 1), view, 500).vectors == 0);
  CHECK(render::survey_volumes({}, view, 500).pixels == 0);
}

TEST_CASE("splats a volume to the same bits in both kernels") {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> place(-30, 70), part(0, 1);
  std::vector<render::VolumeSplat> splats(3000);
  for (auto& s : splats) {
    s = {place(random),       place(random),    0.5f + 20 * part(random) * part(random),
         0.3f * part(random), 1 + part(random), static_cast<std::uint32_t>(random() & 0xFFFFFFu)};
    // Keeps vectors that meet one tile.
    s.x = std::clamp(s.x, 32 - s.reach, 63 + s.reach);
    s.y = std::clamp(s.y, 0 - s.reach, 31 + s.reach);
  }
  for (const std::size_t count : {1u, 7u, 31u, 32u, 200u, 3000u}) {
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0u);
    const auto a = std::make_unique<render::VolumeTile>(), b = std::make_unique<render::VolumeTile>();
    render::volume_kernel().tile(splats.data(), order, 32, 0, *a);
    render::volume_kernel_baseline().tile(splats.data(), order, 32, 0, *b);
    CHECK(std::memcmp(a.get(), b.get(), sizeof *a) == 0);
    CHECK(*std::max_element(a->clear.begin(), a->clear.end()) <= 1);
    CHECK(*std::min_element(a->clear.begin(), a->clear.end()) >= 0);
    for (std::size_t i = 0; i < a->stop.size(); ++i)
      a->stop[i] = b->stop[i] = i % 7 == 0 ? kNaN : i % 5 == 0 ? kInfinity : 1 + part(random);
    render::volume_kernel().stopped_tile(splats.data(), order, 32, 0, *a);
    render::volume_kernel_baseline().stopped_tile(splats.data(), order, 32, 0, *b);
    CHECK(std::memcmp(a.get(), b.get(), sizeof *a) == 0);
    CHECK(*std::min_element(a->clear.begin(), a->clear.end()) >= 0);
    CHECK(a->clear[0] == 1);  // its stop is NaN
  }
}

TEST_CASE("draws the boundary of a volume without holes from few received vectors") {
  std::mt19937 random(2);
  for (const double share : {1.0, 0.25, 0.05, 0.01}) {
    qnv::Volume geometry = empty_volume(0.95f, 1);
    geometry.description.box = {glm::vec3(-64, -64, -1), glm::vec3(63, 63, 1)};
    std::uniform_real_distribution<double> part(0, 1);
    for (int z = -1; z < 2; ++z)
      for (int y = -64; y < 64; ++y)
        for (int x = -64; x < 64; ++x)
          if (part(random) < share) add(geometry, {x, y, z}, {0, 0, 1}, 1, 0);
    SplatView view = straight_view(150, 150);
    view.camera_from_node = glm::lookAt(glm::vec3(0, 0, 40), glm::vec3(0), glm::vec3(0, 1, 0));
    const VolumeLayer layer = drawn(geometry, view);
    REQUIRE(!layer.empty());
    std::size_t holes = 0;
    for (std::size_t i = 0; i < layer.depth.size(); ++i)
      if (layer.pixels[4 * i + 3] < 150) ++holes;
    INFO(geometry.size() << " vectors");
    CHECK(holes <= layer.depth.size() / 200);
  }
}

TEST_CASE("shows less through more opaque volumes, and keeps colours premultiplied") {
  const qnv::Volume geometry = random_volume(3000, 10, 0.06f);
  const SplatView view = view_from({0, 0, 3}, 64, 64);
  double last = 0;
  for (const float opacity : {0.1f, 1.0f, 10.0f}) {
    VolumeOptions options;
    options.opacity = opacity;
    const VolumeLayer layer = drawn(geometry, view, options);
    REQUIRE(!layer.empty());
    double sum = 0;
    for (std::size_t i = 0; i < layer.depth.size(); ++i) {
      const std::uint8_t* p = layer.pixels.data() + 4 * i;
      sum += p[3];
      REQUIRE(std::max({p[0], p[1], p[2]}) <= p[3] + 1);
      REQUIRE((p[3] == 0 || layer.depth[i] > 0));
    }
    CHECK(sum > last);
    last = sum;
  }
}

TEST_CASE("draws or skips hostile volumes") {
  const SplatView view = view_from({0, 0, 3}, 70, 40);
  const qnv::Volume sound = random_volume(300, 11, 0.2f);
  const std::array<float, 9> values = {kNaN, kInfinity, -kInfinity, 0, -1, 1e38f, -1e38f, 1e-38f, 3e9f};
  for (const float v : values) {
    INFO(v);
    for (int what = 0; what < 9; ++what) {
      qnv::Volume geometry = sound;
      VolumeOptions options;
      SplatView other = view;
      for (std::size_t i = 0; i < geometry.size(); i += 3) {
        if (what == 0) geometry.positions[i].y = v;
        if (what == 1) geometry.normals[i].z = v;
        if (what == 2) geometry.weights[i] = v;
      }
      if (what == 3) geometry.description.spacing = v;
      if (what == 4) geometry.description.box = {glm::vec3(v), glm::vec3(-v)};
      if (what == 5) geometry.description.transfer[1].value = geometry.description.transfer[2].opacity = v;
      if (what == 6) options.opacity = options.ambient = v;
      if (what == 7) options.clip = glm::vec4(v, v, 0, v);
      if (what == 8) other.camera_from_node[1][1] = other.near_plane = v;
      const VolumeLayer layer = drawn(geometry, other, options);
      CHECK((layer.empty() || layer.pixels.size() == 4u * 70 * 40));
      (void)raycast_volume(geometry, view_from({0, 0, 3}, 7, 4), options);
    }
  }
  qnv::Volume geometry = sound;
  geometry.description.transfer.clear();
  CHECK(!drawn(geometry, view).empty());
  geometry.classes.clear();
  CHECK(!drawn(geometry, view).empty());
  geometry.classes.resize(7);
  CHECK(drawn(geometry, view).empty());
  geometry = sound;
  geometry.weights.pop_back();
  CHECK(drawn(geometry, view).empty());
  CHECK(drawn({}, view).empty());
  CHECK(drawn(sound, view_from({0, 0, 3}, 0, 40)).empty());
  SplatView away = view;
  away.camera_from_node = glm::lookAt(glm::vec3(0, 0, 30), glm::vec3(0, 0, 60), glm::vec3(0, 1, 0));
  CHECK(drawn(sound, away).empty());  // behind the camera
}

TEST_CASE("ends quickly for coincident vectors, and for one vector in a huge box") {
  qnv::Volume geometry = empty_volume(0.01f, 100);
  for (int i = 0; i < 100'000; ++i) add(geometry, {0, 0, 0}, {0, 0, 1}, 1, 0);
  const SplatView view = view_from({0, 0, 3}, 200, 200);
  (void)drawn(geometry, view);
  geometry.description.box = {glm::vec3(-1e30f), glm::vec3(1e30f)};
  (void)drawn(geometry, view);
  qnv::Volume one = empty_volume(0.9f, 1e-30f);
  one.description.box = {glm::vec3(-1e30f), glm::vec3(1e30f)};
  add(one, {0, 0, 0}, {0, 0, 1}, 1, 0);
  (void)drawn(one, view);
}
